@tool
extends RefCounted
## Delays large changes to the view. A change is large if it would display more than ten times as many instances of a layer, and more than 50,000. The
## view then keeps the layer's old values until the user confirms. The number of instances then grows in steps, which the user can stop. The layer
## itself has its new values immediately, and the game uses them.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")

## Emitted when the result of [method limited] has changed.
signal limits_changed

enum State { ASKING, KEPT, GROWING }

## The user must confirm an increase by more than this factor if it results in more than [constant MIN_COUNT] instances.
const MAX_FACTOR := 10.0
const MIN_COUNT := 50000.0
## The largest factor from one step to the next.
const STEP := 4.0

## A watched layer of a scatter.
class Watch:
	var scatter: TerrainScatter3D
	var layer: ScatterLayer
	var state := State.KEPT
	## True while the view differs from the layer.
	var is_limited := false
	## The values with which the view shows the layer, and the resulting number of instances.
	var shown: Array[float] = []
	var count := 0.0
	var callback: Callable ## Called with this object when the layer changes.

	func notify() -> void:
		callback.call(self)

	## Returns the values that determine a layer's number of instances: radius, density and view distance.
	func numbers() -> Array[float]:
		return [layer.radius, layer.density, layer.view_distance]

	## Returns the estimated number of instances that the layer would show with its current values.
	func estimate() -> float:
		return count * density_of(numbers()) / maxf(density_of(shown), 1e-9)

	## Returns a number that is proportional to the number of instances of a layer with these values.
	static func density_of(values: Array[float]) -> float:
		return values[1] * pow(values[2] / values[0], 2.0)

	## Shows the layer in the view with these values, or with the layer's values if [param values] is empty.
	func show(values: Array[float]) -> void:
		var stand_in: ScatterLayer = null
		if not values.is_empty():
			stand_in = layer.duplicate()
			stand_in.radius = values[0]
			stand_in.density = values[1]
			stand_in.view_distance = values[2]
		is_limited = stand_in != null
		scatter._set_preview_stand_in(layer, stand_in)


var _watches: Array[Watch] = []


## Returns the layers that the view shows with values other than their own. Layers that wait for a confirmation come first.
func limited() -> Array[Watch]:
	var result := _watches.filter(func(watch: Watch) -> bool: return watch.is_limited)
	result.sort_custom(func(a: Watch, b: Watch) -> bool: return a.state < b.state)
	return result


## Returns the watch of one layer, or null if the view shows that layer with its own values.
func limited_of(scatter: TerrainScatter3D, layer: ScatterLayer) -> Watch:
	for watch in _watches:
		if watch.is_limited and watch.scatter == scatter and watch.layer == layer:
			return watch
	return null


## Watches the layers of a scatter in addition to those that are already watched. If [param scatter] is null, adds no layers. Called several times per
## second.
func refresh(scatter: TerrainScatter3D) -> void:
	for watch: Watch in _watches.duplicate():
		if not is_instance_valid(watch.scatter) or not watch.layer in ScatterLayers.of(watch.scatter):
			_stop_watching(watch)
	if is_instance_valid(scatter):
		for layer in ScatterLayers.of(scatter):
			if layer != null and not _watches.any(func(watch: Watch) -> bool: return watch.layer == layer and watch.scatter == scatter):
				_start_watching(scatter, layer)
	for watch in _watches:
		if watch.scatter.is_inside_tree() and watch.scatter.is_settled():
			_on_settled(watch)


## Increases the number of instances in the view in steps until all of them are shown.
func grow(watch: Watch) -> void:
	watch.state = State.GROWING
	_step(watch)


## Keeps the current view.
func keep(watch: Watch) -> void:
	watch.state = State.KEPT
	limits_changed.emit()


## Shows all layers with their own values and stops watching them.
func clear() -> void:
	for watch: Watch in _watches.duplicate():
		_stop_watching(watch)


func _start_watching(scatter: TerrainScatter3D, layer: ScatterLayer) -> void:
	var watch := Watch.new()
	watch.scatter = scatter
	watch.layer = layer
	watch.shown = watch.numbers()
	watch.count = scatter.get_shown_count(layer)
	watch.callback = _on_changed
	layer.changed.connect(watch.notify)
	_watches.append(watch)


func _stop_watching(watch: Watch) -> void:
	watch.layer.changed.disconnect(watch.notify)
	_watches.erase(watch)
	if watch.is_limited:
		if is_instance_valid(watch.scatter):
			watch.show([])
		limits_changed.emit()


## Leaves the view unchanged if a change needs confirmation. Called before the node processes the change, so that it does not generate the new
## instances.
func _on_changed(watch: Watch) -> void:
	if not is_instance_valid(watch.scatter):
		return
	var estimate := watch.estimate()
	if estimate <= maxf(MAX_FACTOR * watch.count, MIN_COUNT):
		if watch.is_limited:
			watch.show([])
			limits_changed.emit()
	elif watch.is_limited and watch.state == State.GROWING:
		_step(watch)
	else:
		if not watch.is_limited:
			watch.state = State.ASKING
		watch.show(watch.shown)
		limits_changed.emit()


func _on_settled(watch: Watch) -> void:
	if watch.is_limited and watch.state == State.GROWING:
		watch.count = watch.scatter.get_shown_count(watch.layer)
		_step(watch)
	elif watch.is_limited:
		watch.count = watch.scatter.get_shown_count(watch.layer)
	else:
		watch.shown = watch.numbers()
		watch.count = watch.scatter.get_shown_count(watch.layer)


## Takes the next step toward the layer's values. The last step shows the layer itself.
func _step(watch: Watch) -> void:
	var target := watch.numbers()
	var factor := Watch.density_of(target) / maxf(Watch.density_of(watch.shown), 1e-9)
	if factor <= STEP:
		watch.show([])
	else:
		var step_fraction := log(STEP) / log(factor)
		for index in target.size():
			watch.shown[index] = maxf(watch.shown[index], 1e-3) * pow(maxf(target[index], 1e-3) / maxf(watch.shown[index], 1e-3), step_fraction)
		watch.show(watch.shown)
	limits_changed.emit()
