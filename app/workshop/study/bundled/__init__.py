"""Protocols of published studies, their printed figures, and participants that simulate them.

Each has a .toml and, named in it as `printed`, a module with `printed_tables`, `own_tables` and,
where shares of answers do not say it, `simulated_answer`.
"""
