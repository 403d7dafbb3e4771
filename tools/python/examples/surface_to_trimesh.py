"""The surface of a splash as a mesh of trimesh or PyVista where one is installed, and as an OBJ file.
surface_to_trimesh.py [OBJ]"""
import sys

import numpy

import mallow

simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
simulation.add_collider(mallow.Collider())
ball = mallow.sample(mallow.sphere_shape([0, 0, 0.3], 0.1), mallow.Sampling(spacing=0.02))
simulation.add_body(ball, mallow.materials.honey(), "ball")
surfacer = mallow.Surfacer(mallow.SurfaceConfig())
for _ in range(10):
    simulation.advance(1 / 30)
    mesh = surfacer.draw(simulation)
    corners = mesh.vertices[mesh.triangles].astype(float)
    volume = numpy.linalg.det(corners).sum() / 6
    print(f"{simulation.time:.2f} s: {len(mesh.triangles)} triangles, {1e6 * volume:.0f} cm³")

try:
    import trimesh
    print("trimesh:", trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).is_watertight)
except ImportError:
    print("trimesh is not installed")
try:
    import pyvista
    print("PyVista:", pyvista.make_tri_mesh(mesh.vertices, mesh.triangles).volume)
except ImportError:
    print("PyVista is not installed")
mallow.write_mesh_obj(sys.argv[1] if len(sys.argv) > 1 else "splash.obj", mesh)
# Where it is one particle thin, what is drawn is a little thinner.
assert mallow.why_not_closed(mesh) == "" and 0.8 < volume / len(ball) / 0.02**3 < 1.3
