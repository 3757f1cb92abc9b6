"""FBX, binary and ASCII: records, the objects they describe, and the animation curves that move these."""
