"""A language model that answers what a script has no answer to."""
