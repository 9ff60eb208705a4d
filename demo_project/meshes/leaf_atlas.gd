extends RefCounted
## The regions of the texture that all plants share. [code]leaf_atlas_drawing.gd[/code] draws it, and [code]save_models.gd[/code] saves it with the
## plants of the presets.
##
## The color is a brightness, which the vertex color tints. Alpha is used with an alpha scissor.

const SIZE := Vector2i(2560, 1024)
## The width of a leaf's square region in texels.
const CELL := 512
## A spray of broad leaves.
const BROADLEAF := Rect2(0.0, 0.0, 0.2, 0.5)
## A conifer's twig, from the stem on the left to the tip on the right.
const TWIG := Rect2(0.2, 0.0, 0.2, 0.5)
## A fern's frond, from the stem on the left to the tip on the right.
const FROND := Rect2(0.0, 0.5, 0.2, 0.5)
## A round tuft of long needles.
const TUFT := Rect2(0.2, 0.5, 0.2, 0.5)
## The crown of a broadleaf tree, for distant LODs.
const CROWN := Rect2(0.8, 0.0, 0.2, 0.5)
## A whole conifer, for distant LODs.
const CONIFER := Rect2(0.8, 0.5, 0.1, 0.5)
## An opaque white texel, for surfaces without a texture.
const OPAQUE_UV := Vector2(2016.0 / 2560.0, 0.5)
## Columns of bark that wrap around a trunk: furrows as on an oak, scales as on a spruce, marks as on a birch. They repeat vertically, so that the bark
## has the same scale on a trunk of any length.
const BARKS: Array[Rect2] = [
	Rect2(1056.0 / 2560.0, 0.0, 0.1, 1.0), Rect2(1376.0 / 2560.0, 0.0, 0.1, 1.0), Rect2(1696.0 / 2560.0, 0.0, 0.1, 1.0),
]
## The length of a column, as a multiple of the trunk's circumference.
const BARK_LENGTH := 4.0
const FILE := "res://addons/thicket/presets/plants/atlas.res"


## Returns the texture that the add-on contains.
static func texture() -> Texture2D:
	return load(FILE)
