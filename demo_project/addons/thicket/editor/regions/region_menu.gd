@tool
extends MenuButton
## The menu that adds a region as a child of the scatter. The region is placed on the ground at the center of the view. For a
## polygon or a path, the user clicks its points.

const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## Emitted when the user wants to draw a polygon or a path that excludes or includes layers.
signal drawing_requested(shape: ScatterRegion3D.Shape, exclude: bool)

const SHAPE_NAMES: PackedStringArray = ["Box", "Sphere", "Cylinder", "Polygon", "Path"]
## The smallest and the largest size of a new region in meters. Between these limits, the size is the fraction [constant
## SIZE_FACTOR] of the distance from the camera.
const SIZES := Vector2(2.0, 200.0)
const SIZE_FACTOR := 0.3

var undo_redo: EditorUndoRedoManager
var scatter: TerrainScatter3D


func _init() -> void:
	text = "Region"
	tooltip_text = "Add a region at the center of the view. It excludes layers or limits them to its area."
	set_meta(&"icon", &"Add")
	var popup := get_popup()
	for exclude: bool in [true, false]:
		popup.add_separator("Exclude Layers" if exclude else "Limit Layers")
		for shape in SHAPE_NAMES.size():
			popup.add_item(SHAPE_NAMES[shape], shape + (0 if exclude else SHAPE_NAMES.size()))
	popup.id_pressed.connect(_on_chosen)


## Adds a box, a sphere or a cylinder at the center of the view, as one undo step, and selects it. Without a ground, it is 20 meters from the camera.
func add(shape: ScatterRegion3D.Shape, exclude: bool) -> void:
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var distance := 20.0
	if scatter.ground != null:
		distance = SurfacePlace.distance(scatter, camera.global_position, -camera.global_basis.z)
	var size := clampf(snappedf(distance * SIZE_FACTOR, 1.0), SIZES.x, SIZES.y)
	var region := make(shape, exclude)
	region.size = Vector3(size, maxf(size, 10.0), size)
	region.radius = 0.5 * size
	region.height = maxf(size, 10.0)
	insert(region, camera.global_position - camera.global_basis.z * distance)


## Creates a region without adding it to the scene.
static func make(shape: ScatterRegion3D.Shape, exclude: bool) -> ScatterRegion3D:
	var region := ScatterRegion3D.new()
	region.name = ("Without%s" if exclude else "Only%s") % SHAPE_NAMES[shape]
	region.shape = shape
	region.exclude = exclude
	return region


## Adds a region at a world position, as one undo step, and selects it. On a planet, its y axis points away from the center.
func insert(region: ScatterRegion3D, point: Vector3) -> void:
	region.transform = scatter.global_transform.affine_inverse() * frame_at(scatter, point)
	undo_redo.create_action("Add %s" % region.name, UndoRedo.MERGE_DISABLE, scatter)
	add_as_child(undo_redo, scatter, region)
	undo_redo.commit_action()
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(region)


## Returns the transform of a new region at a world position.
static func frame_at(scatter: TerrainScatter3D, point: Vector3) -> Transform3D:
	return Transform3D(SurfacePlace.upright(SurfacePlace.up_at(scatter, point)), point)


## Adds to the open undo step: adding a node, with its children, to a parent.
static func add_as_child(undo: EditorUndoRedoManager, parent: Node, node: Node) -> void:
	var root := EditorInterface.get_edited_scene_root()
	undo.add_do_method(parent, &"add_child", node, true)
	undo.add_do_property(node, &"owner", root)
	if node.scene_file_path.is_empty():
		for child in node.get_children():
			undo.add_do_property(child, &"owner", root)
	undo.add_do_reference(node)
	undo.add_undo_method(parent, &"remove_child", node)


func _on_chosen(id: int) -> void:
	if not is_instance_valid(scatter):
		return
	var shape := (id % SHAPE_NAMES.size()) as ScatterRegion3D.Shape
	var exclude := id < SHAPE_NAMES.size()
	if shape in [ScatterRegion3D.SHAPE_POLYGON, ScatterRegion3D.SHAPE_PATH]:
		drawing_requested.emit(shape, exclude)
	else:
		add(shape, exclude)
