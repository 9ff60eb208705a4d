extends "allocation_harness.gd"
## A scene that uses streaming, queries, changes, states, masks and samplers.


func steps() -> Array[Callable]:
	return [query, explain, change, change_by_bytes, add_by_hand, paint, sample_points, sample_domains]


func make_scene() -> void:
	var trees := make_layer("trees", 4.0, [make_model(BoxMesh.new(), BoxMesh.new()), make_model(SphereMesh.new(), BoxMesh.new())])
	trees.layer_id = 3
	trees.min_scale = 0.6
	trees.max_scale = 1.7
	trees.collision_shape = ScatterLayer.COLLISION_CYLINDER
	trees.collision_distance = 16.0
	var ferns := make_layer("ferns", 3.0, [BoxMesh.new()])
	ferns.layer_id = 4
	ferns.spacing = {"trees": 1.5}
	ferns.use_custom_data = true
	ferns.mask = ScatterMask.new()
	ferns.mask.background = 1.0
	var ground := ScatterGroundNoise.new()
	ground.noise = FastNoiseLite.new()
	ground.amplitude = 5.0
	make_scatter([trees, ferns], ground)
	var glade := ScatterRegion3D.new()
	glade.exclude = true
	glade.radius = 5.0
	scatter.add_child(glade)


## Returns a model whose LOD `far` is drawn from 20 m on.
func make_model(near: Mesh, far: Mesh) -> ScatterModel:
	var model := ScatterModel.new()
	model.lods = [ScatterLod.new(), ScatterLod.new()]
	model.lods[0].mesh = near
	model.lods[1].mesh = far
	model.lods[1].distance = 20.0
	return model


func query() -> void:
	var found := scatter.query_rect(Rect2(-20, -20, 40, 40))
	answers.push_back([found.ids, found.layer_indices, found.meshes, found.positions, found.transforms])
	answers.push_back(scatter.query_ray(Vector3(-10, 1, -10), Vector3(10, 1, 12)))
	var nearest := scatter.query_nearest(Vector3(3, 0, 3), 20.0)
	answers.push_back(nearest.id if nearest != null else 0)


func explain() -> void:
	for explanation: ScatterExplanation in scatter.explain_position(Vector3(6, 0, 6)):
		answers.push_back([explanation.get_density(), explanation.get_reason()])
		if explanation.get_refused_by() == &"layer":
			push_error(explanation.get_reason()) # This error counts as the report of the failure.
	answers.push_back(scatter.get_density_map(scatter.layers[1], Rect2(0, 0, 8, 8), Vector2i(4, 4)))


func change() -> void:
	var found := scatter.query_rect(Rect2(5, 5, 15, 15), scatter.layers[0])
	answers.push_back(scatter.remove_instances(found.ids))
	answers.push_back([scatter.state.get_removed(), scatter.state.get_revision()])


func change_by_bytes() -> void:
	var other := ScatterState.new()
	answers.push_back(other.from_bytes(scatter.state.to_bytes()))
	other.clear()
	answers.push_back(other.apply_diff(scatter.state.diff_since(0)))
	answers.push_back([other.data.size(), other.get_removed()])


func add_by_hand() -> void:
	var transforms: PackedFloat32Array
	for index in 20:
		transforms.append_array([1, 0, 0, index, 0, 1, 0, 0, 0, 0, 1, 3])
	answers.push_back(scatter.add_instances(scatter.layers[0], transforms))
	answers.push_back(scatter.state.get_added())


func paint() -> void:
	var mask := scatter.layers[1].mask
	answers.push_back(mask.paint(Vector2(8, 8), 6.0, 1.0, 0.5, ScatterMask.MODE_ERASE))
	answers.push_back([mask.data, mask.get_pixels(Rect2i(0, 0, 16, 16))])


func sample_points() -> void:
	var sampler := PoissonSampler.new()
	sampler.radius = 1.0
	var points := sampler.sample(Rect2(0, 0, 20, 20))
	answers.push_back([points.ids, points.ranks, points.positions])
	var exact := sampler.sample_exact(0, 0, 20, 20)
	answers.push_back([exact.ids, exact.x, exact.positions])


func sample_domains() -> void:
	var sampler := PoissonSampler.new()
	sampler.method = PoissonSampler.METHOD_HIERARCHICAL
	answers.push_back(sampler.sample_domain(Rect2(0, 0, 20, 20)))
	answers.push_back(sampler.sample_domain_exact(0, 0, 20, 20).y)
