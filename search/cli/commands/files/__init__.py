"""Commands that write a motion or a picture: export, render, compose."""
