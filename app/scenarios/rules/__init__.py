"""Scenarios that are a file of rules, for those who do not program; see docs/rules.md."""
