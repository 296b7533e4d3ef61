"""The effects of a plate (`plate`) and of a ball (`ball`): when each is called for, what rules it out, words and terms.

`selection` decides by these which a scene has. May import scene, and `fem` to look at coarse meshes.
"""
