"""TMR's networks, with the normalisation and padding of their inputs."""
