#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thicket {

/// The name of a node, split into its stem and the number that artists give an LOD.
struct LodName {
	std::string stem;       ///< The name without the mark and its separator: "Trunk" of "Trunk_LOD1". May be empty.
	std::optional<int> lod; ///< 0 to 99; none for a name without a mark.

	friend bool operator==(const LodName &, const LodName &) = default;
};

/// Splits a name. The mark is "LOD" and a number of one or two digits, in upper or lower case. "_", "-", "." or a blank
/// may separate them. The mark must begin and end at the border of a word: "Tree_LOD0", "lod1", "TrunkLOD2" and
/// "Tree-lod-1_leaves" have one; "Melod1" and "LOD100" have none. The last mark counts.
LodName read_lod_name(std::string_view name);

/// The properties of a model's part that decide in which LODs it is drawn.
struct PartRange {
	std::string stem;       ///< LodName::stem of its node.
	std::optional<int> lod; ///< From the name of its node, or of the nearest ancestor that has a mark.
	double begin = 0.0;     ///< Meters from which it is visible (visibility_range_begin), 0 for no limit,
	double end = 0.0;       ///< and up to which, 0 for no limit.
};

/// An LOD of a model.
struct ModelLod {
	std::optional<double> distance; ///< Meters from which it is drawn; none if the scene does not define it.
	std::vector<std::size_t> parts; ///< Indices, ascending.

	friend bool operator==(const ModelLod &, const ModelLod &) = default;
};

/// Sorts the parts of a model into LODs, the finest first. Any parts result in at least one LOD, no parts in none.
///
/// If any part has a number, numbers decide: each number that occurs becomes an LOD, in ascending order. A part without
/// a number counts as number 0 if a numbered part has the same stem, else it belongs to all LODs. An LOD begins at the
/// largest `begin` of its numbered parts, if that is above 0.
///
/// Otherwise the ranges decide: an LOD begins at each distance at which parts appear or disappear, as long as something is drawn there. The
/// last LOD has no end, because the layer's settings decide how far it is visible.
std::vector<ModelLod> model_lods(std::span<const PartRange> parts);

/// The default distance in meters from which the LOD of this index is drawn, for a model whose box has a diagonal of
/// `size` meters; 0 for the first LOD. Each further LOD begins when the model is about half as large on the screen.
double usual_lod_distance(double size, std::size_t lod);

} // namespace thicket
