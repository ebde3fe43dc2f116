"""Characters: skeleton, meshes, clips and sidecar file."""
