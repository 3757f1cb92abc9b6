"""TMR in torch: networks, text features, training, and conversion to and from bundles. Needs the extra `train`."""
