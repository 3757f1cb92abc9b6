"""Gestures of arms, hands and head: alone, towards others, and of feelings."""
