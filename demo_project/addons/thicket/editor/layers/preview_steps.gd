@tool
extends RefCounted
## Stands between a change and the view: where a layer would show more than ten times as much as it does, the view keeps what it has, until
## the designer has been asked; then it grows in steps that can be stopped. The layer has its new values all the while, and so has the game.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")

## There is something else to tell, or nothing any more.
signal told

enum State { ASKING, KEPT, GROWING }

## So many times as much is asked about, if it is more than this many instances.
const MANY := 10.0
const FEW := 50000.0
## A step shows at most so many times as much as the one before.
const STEP := 4.0

## A layer of a scatter that is looked after.
class Watch:
	var scatter: TerrainScatter3D
	var layer: ScatterLayer
	var state := State.KEPT
	## True while the view differs from the layer.
	var held := false
	## The numbers that the view shows, and the instances that were counted with them.
	var shown: Array[float] = []
	var count := 0.0
	var heard: Callable ## Told of a change of the layer.

	func hear() -> void:
		heard.call(self)

	## What a layer's number of instances follows from: radius, density and view distance.
	func numbers() -> Array[float]:
		return [layer.radius, layer.density, layer.view_distance]

	## The instances that the layer would show as it is now.
	func estimate() -> float:
		return count * density_of(numbers()) / maxf(density_of(shown), 1e-9)

	## In proportion to the instances of a layer with these values.
	static func density_of(values: Array[float]) -> float:
		return values[1] * pow(values[2] / values[0], 2.0)

	## Shows the layer with other values in the view; with its own for none.
	func show(values: Array[float]) -> void:
		var stand_in: ScatterLayer = null
		if not values.is_empty():
			stand_in = layer.duplicate()
			stand_in.radius = values[0]
			stand_in.density = values[1]
			stand_in.view_distance = values[2]
		held = stand_in != null
		scatter._set_preview_stand_in(layer, stand_in)


var _watches: Array[Watch] = []


## What is to be told: the layers whose view differs, those that ask first.
func held() -> Array[Watch]:
	var result := _watches.filter(func(watch: Watch) -> bool: return watch.held)
	result.sort_custom(func(a: Watch, b: Watch) -> bool: return a.state < b.state)
	return result


## The same for a layer; null for one that is shown as it is.
func held_of(scatter: TerrainScatter3D, layer: ScatterLayer) -> Watch:
	for watch in _watches:
		if watch.held and watch.scatter == scatter and watch.layer == layer:
			return watch
	return null


## Looks after the layers of a scatter, some times a second; null for none. Those that were looked after before still are.
func look(scatter: TerrainScatter3D) -> void:
	for watch: Watch in _watches.duplicate():
		if not is_instance_valid(watch.scatter) or not watch.layer in ScatterLayers.of(watch.scatter):
			_forget(watch)
	if is_instance_valid(scatter):
		for layer in ScatterLayers.of(scatter):
			if layer != null and not _watches.any(func(watch: Watch) -> bool: return watch.layer == layer and watch.scatter == scatter):
				_begin(scatter, layer)
	for watch in _watches:
		if watch.scatter.is_inside_tree() and watch.scatter.is_settled():
			_settled(watch)


## Lets the view grow, step by step, until it shows all.
func grow(watch: Watch) -> void:
	watch.state = State.GROWING
	_step(watch)


## Keeps the view as it is.
func keep(watch: Watch) -> void:
	watch.state = State.KEPT
	told.emit()


## Shows all layers as they are, and looks after none.
func clear() -> void:
	for watch: Watch in _watches.duplicate():
		_forget(watch)


func _begin(scatter: TerrainScatter3D, layer: ScatterLayer) -> void:
	var watch := Watch.new()
	watch.scatter = scatter
	watch.layer = layer
	watch.shown = watch.numbers()
	watch.count = scatter.get_shown_count(layer)
	watch.heard = _on_changed
	layer.changed.connect(watch.hear)
	_watches.append(watch)


func _forget(watch: Watch) -> void:
	watch.layer.changed.disconnect(watch.hear)
	_watches.erase(watch)
	if watch.held:
		if is_instance_valid(watch.scatter):
			watch.show([])
		told.emit()


## Before the node has looked at the layer, so that the view makes nothing of it.
func _on_changed(watch: Watch) -> void:
	if not is_instance_valid(watch.scatter):
		return
	var estimate := watch.estimate()
	if estimate <= maxf(MANY * watch.count, FEW):
		if watch.held:
			watch.show([])
			told.emit()
	elif watch.held and watch.state == State.GROWING:
		_step(watch)
	else:
		if not watch.held:
			watch.state = State.ASKING
		watch.show(watch.shown)
		told.emit()


func _settled(watch: Watch) -> void:
	if watch.held and watch.state == State.GROWING:
		watch.count = watch.scatter.get_shown_count(watch.layer)
		_step(watch)
	elif watch.held:
		watch.count = watch.scatter.get_shown_count(watch.layer)
	else:
		watch.shown = watch.numbers()
		watch.count = watch.scatter.get_shown_count(watch.layer)


## The next step towards what the layer is now; the last shows the layer itself.
func _step(watch: Watch) -> void:
	var wanted := watch.numbers()
	var times := Watch.density_of(wanted) / maxf(Watch.density_of(watch.shown), 1e-9)
	if times <= STEP:
		watch.show([])
	else:
		var part := log(STEP) / log(times)
		for index in wanted.size():
			watch.shown[index] = maxf(watch.shown[index], 1e-3) * pow(maxf(wanted[index], 1e-3) / maxf(watch.shown[index], 1e-3), part)
		watch.show(watch.shown)
	told.emit()
