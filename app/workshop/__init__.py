"""What is made of sessions and for them, apart from play: tables, plots, editor, studies."""
