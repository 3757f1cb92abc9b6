"""How good the answers are: retrieval protocols, labelled archives, moments."""
