"""Synthetic captioned motion: actions, the engine that moves a body through them, captions, composition."""
