"""TMR to and from files: bundles with their ONNX graphs, and published run directories."""
