"""The wizard's desk: a page by which an experimenter drives character and robot unseen."""
