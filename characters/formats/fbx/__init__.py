"""FBX (.fbx): read by the library ufbx, in a process of its own, as glTF."""
