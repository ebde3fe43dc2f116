"""Behaving: characters that perform blocks of BML, for a file or while they play."""
