"""`motionseek model`: one module a command, and the group that gathers them."""
