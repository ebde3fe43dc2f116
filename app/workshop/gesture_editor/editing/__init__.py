"""What is edited, and how: the document, its edits, its files, and the state of the editor."""
