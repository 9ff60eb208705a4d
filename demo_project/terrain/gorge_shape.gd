extends RefCounted
## Defines the rock of the surfaces scene by a formula. A plateau has a gorge with a brook, and the gorge's east wall has a tunnel with a collapsed
## roof. [method air] returns the approximate distance to the rock, which is negative inside the rock.

## The height of the plateau around the bridge, in meters.
const TOP := 14.0
## The points along the middle of the tunnel's floor. Both ends of the tunnel are in the gorge.
const TUNNEL: Array[Vector3] = [
	Vector3(4.0, 1.3, 33.0), Vector3(28.0, 2.0, 15.0), Vector3(33.0, 2.2, -1.0), Vector3(25.0, 1.8, -14.0), Vector3(-2.0, 1.2, -20.0),
]
## The hole in the tunnel's roof: the x and z of its center, and its radius.
const SKYLIGHT := Vector3(19.5, 22.0, 3.3)
## The level parts of the plateau, as x, z and radius: one at the bridge and one at the ruin.
const LEVEL: Array[Vector3] = [Vector3(0.0, 0.0, 17.0), Vector3(-26.0, -13.0, 12.0)]

var _hills := FastNoiseLite.new()
var _bumps := FastNoiseLite.new()


func _init() -> void:
	_hills.seed = 4
	_hills.frequency = 0.012
	_hills.fractal_octaves = 3
	_bumps.seed = 9
	_bumps.frequency = 0.085
	_bumps.fractal_octaves = 3


## Returns the x of the gorge's center line at a position z.
func middle(z: float) -> float:
	return 6.0 * sin(z * 0.05)


## Returns the height of the land without the gorge, in meters.
func plateau(x: float, z: float) -> float:
	var distance := Vector2(x, z).length()
	var hilliness := 1.0
	for level in LEVEL:
		hilliness = minf(hilliness, smoothstep(level.z, level.z + 16.0, Vector2(x - level.x, z - level.y).length()))
	var noise := _hills.get_noise_2d(x, z)
	return TOP + hilliness * (1.0 + 5.0 * noise) + 34.0 * smoothstep(70.0, 280.0, distance) * (0.75 + noise)


## Returns the height of the gorge's bed, in meters.
func bed(x: float, z: float) -> float:
	var middle_distance := absf(x - middle(z))
	var noise := _bumps.get_noise_2d(x, z)
	return 0.9 + 0.6 * noise - 1.6 * exp(-middle_distance * middle_distance / 8.0) + 1.6 * smoothstep(4.5, 9.0, middle_distance) + 16.0 * smoothstep(48.0, 74.0, absf(z)) ** 2


## Returns the distance to the rock in meters, negative inside it. Far from the rock, it is only approximate. [param roughness] is a factor for the rock's
## bumps.
func air(point: Vector3, roughness := 1.0) -> float:
	var height_above_plateau := point.y - plateau(point.x, point.z)
	if height_above_plateau > 5.0:
		return height_above_plateau
	var noise := _bumps.get_noise_3d(point.x, point.y * 1.6, point.z) if roughness > 0.0 else 0.0
	var height_above_bed := point.y - bed(point.x, point.z)
	# The walls rise in steps, whose heights differ along the gorge.
	var course := (point.y + 5.0 * _hills.get_noise_2d(point.z * 2.0, 70.0 * signf(point.x - middle(point.z)))) / 4.6
	var half_width := 7.0 + 1.9 * (floorf(course) + smoothstep(0.62, 1.0, course - floorf(course))) + 3.5 * _hills.get_noise_2d(point.z * 3.0, point.x)
	half_width -= 2.2 * exp(-point.z * point.z / 120.0) + 14.0 * smoothstep(46.0, 76.0, absf(point.z))
	var gorge := minf(half_width - absf(point.x - middle(point.z)), height_above_bed)
	var tunnel := -100.0
	for i in (TUNNEL.size() - 1 if point.x > -7.0 and point.y < 10.0 and absf(point.z - 6.0) < 34.0 else 0):
		var nearest := Geometry3D.get_closest_point_to_segment(point, TUNNEL[i], TUNNEL[i + 1])
		var horizontal_distance := Vector2(point.x - nearest.x, point.z - nearest.z).length()
		var height_above_floor := point.y - nearest.y
		tunnel = maxf(tunnel, minf(4.3 - Vector2(horizontal_distance, maxf(height_above_floor - 0.8, 0.0) * 0.95).length(), height_above_floor + 0.4 * noise))
	var hole := SKYLIGHT.z + 0.16 * (point.y - 8.0) - Vector2(point.x - SKYLIGHT.x, point.z - SKYLIGHT.y).length()
	tunnel = maxf(tunnel, minf(hole, point.y - 4.0))
	var steepness := smoothstep(0.3, 2.5, -height_above_plateau) * smoothstep(0.0, 2.0, height_above_bed)
	return _smooth_max(_smooth_max(height_above_plateau, gorge, 0.8), tunnel, 0.7) + noise * lerpf(0.35, 2.1, steepness)


## Returns how open a point on the rock is, from 0 in a cave to 1 below the open sky.
func openness(point: Vector3, normal: Vector3) -> float:
	var sky := (normal + Vector3.UP).normalized()
	var visibility := 0.0
	for step: float in [1.2, 3.0, 6.5]:
		visibility += clampf(air(point + normal * step, 0.0) / step, 0.0, 1.0) + clampf(air(point + sky * step * 1.6, 0.0) / step, 0.0, 1.0)
	return visibility / 6.0


## Returns how far a point is inside the tunnel, from 0 outside to 1 at its middle.
func inside(point: Vector3) -> float:
	var depth := 0.0
	for i in TUNNEL.size() - 1:
		var nearest := Geometry3D.get_closest_point_to_segment(point, TUNNEL[i], TUNNEL[i + 1])
		depth = maxf(depth, 1.0 - smoothstep(4.0, 7.0, nearest.distance_to(point)))
	return depth * smoothstep(11.0, 20.0, absf(point.x - middle(point.z)))


static func _smooth_max(a: float, b: float, width: float) -> float:
	var overlap := maxf(width - absf(a - b), 0.0) / width
	return maxf(a, b) + overlap * overlap * width * 0.25
