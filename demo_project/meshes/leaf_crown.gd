extends RefCounted
## Fills clumps with leaf cards to build the crown of a tree or shrub. Leaves are darker inside and below, and lit as parts of one round crown.

const Builder := preload("res://meshes/mesh_builder.gd")

## The region of the atlas that is shown on the cards.
var region := Rect2()
## The color of the lowest and innermost leaves, and the color of the highest and outermost leaves.
var low := Color.BLACK
var high := Color.WHITE
## The center of the crown.
var center := Vector3.ZERO
## The distance from the center to the outermost leaves, in meters.
var radius := 1.0
## The heights of the lowest and of the highest leaves, in meters.
var heights := Vector2(0.0, 1.0)
## The height of a clump, as a fraction of its width.
var flatness := 1.0
var random := RandomNumberGenerator.new()


## Adds [param count] cards to each clump. A clump is a Vector4 with the center and the radius. [param size] is half the width of a card in meters.
func add(builder: Builder, clumps: Array[Vector4], count: int, size: float) -> void:
	for clump in clumps:
		var clump_center := Vector3(clump.x, clump.y, clump.z)
		var clump_direction := (clump_center - center).normalized()
		for i in count:
			var direction := _direction(i, count)
			# Mirrors leaves that would be where the clump touches its neighbors.
			if direction.dot(clump_direction) < -0.35:
				direction = (direction - clump_direction * 2.0 * direction.dot(clump_direction)).normalized()
			var distance := random.randf_range(0.55, 0.95) if count > 2 else 0.35
			var position := clump_center + direction * Vector3(1.0, flatness, 1.0) * clump.w * distance
			_card(builder, position, direction, clump_direction, size * random.randf_range(0.85, 1.2))


func _card(builder: Builder, position: Vector3, direction: Vector3, clump_direction: Vector3, size: float) -> void:
	var from_center := position - center
	var height := clampf((position.y - heights.x) / (heights.y - heights.x), 0.0, 1.0)
	var depth := clampf(from_center.length() / radius, 0.0, 1.0)
	var color := low.lerp(high, clampf(0.1 + 0.5 * height * depth + 0.4 * depth * depth + random.randf_range(-0.12, 0.16), 0.0, 1.0))
	color.a = clampf(0.1 + 0.65 * depth * depth + 0.35 * height, 0.0, 1.0)
	var normal := from_center.normalized() * 0.8 + direction * 0.4 + Vector3.UP * 0.25
	var face := (direction + clump_direction * 0.4 + Vector3(random.randf_range(-0.4, 0.4), random.randf_range(-0.2, 0.5),
			random.randf_range(-0.4, 0.4))).normalized()
	var right := face.cross(Vector3.UP + Vector3(0.01, 0.0, 0.0)).normalized().rotated(face, random.randf() * TAU)
	builder.card(position, right * size, right.cross(face) * size, normal, region, color)


## Returns the i-th of n directions that are spread evenly over the sphere.
func _direction(i: int, n: int) -> Vector3:
	var y := 1.0 - 2.0 * (i + 0.5) / n
	var angle := i * 2.39996 + random.randf() * 0.8
	var ring := sqrt(1.0 - y * y)
	return Vector3(cos(angle) * ring, y, sin(angle) * ring)
