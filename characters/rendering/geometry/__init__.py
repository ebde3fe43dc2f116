"""Meshes on the graphics card: vertex buffers, skinning and morphs."""
