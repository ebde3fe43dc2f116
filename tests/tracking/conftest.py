"""Lets the tests of a process share what is the same in all synthetic pictures."""

from tests.drawn_once import desks_are_drawn_once as desks_are_drawn_once
