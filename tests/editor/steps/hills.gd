@tool
extends RefCounted
## A hilly ground mesh of 200 by 200 m, as a modeling program would export it.


static func mesh() -> ArrayMesh:
	var plane := PlaneMesh.new()
	plane.size = Vector2(200.0, 200.0)
	plane.subdivide_width = 79
	plane.subdivide_depth = 79
	var arrays := plane.get_mesh_arrays()
	var hills := FastNoiseLite.new()
	hills.seed = 3
	hills.frequency = 0.008
	for index in arrays[Mesh.ARRAY_VERTEX].size():
		arrays[Mesh.ARRAY_VERTEX][index].y = 14.0 * hills.get_noise_2d(arrays[Mesh.ARRAY_VERTEX][index].x, arrays[Mesh.ARRAY_VERTEX][index].z)
	var surface_tool := SurfaceTool.new()
	surface_tool.create_from_arrays(arrays)
	surface_tool.generate_normals()
	var earth := StandardMaterial3D.new()
	earth.albedo_color = Color(0.24, 0.27, 0.13)
	earth.roughness = 1.0
	surface_tool.set_material(earth)
	return surface_tool.commit()
