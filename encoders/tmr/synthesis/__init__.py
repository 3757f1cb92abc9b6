"""A generator of motion beside a trained model: TEMOS's variational autoencoder on the model's sentence vectors."""
