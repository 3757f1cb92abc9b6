"""Figures of generated motion as pure functions of vectors and joints, one subject a module.

A paper that is named defines the figure in its section on evaluation metrics; TEMOS, TMR and STMC also in chapters 4, 5
and 6 of Petrovich's thesis (2024).
"""
