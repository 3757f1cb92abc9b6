"""glTF 2.0, GLB and VRM: the container, accessors, nodes and skins, animations, and the humanoid's bones."""
