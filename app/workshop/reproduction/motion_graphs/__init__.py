"""What motion graphs of recordings do: chapters 3 and 3.5 of Fernández-Baena 2015."""
