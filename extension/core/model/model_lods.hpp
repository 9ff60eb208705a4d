#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thicket {

/// A node's name, as artists number levels of detail.
struct LodName {
	std::string stem;       ///< The name without the mark and what separates it: "Trunk" of "Trunk_LOD1". May be empty.
	std::optional<int> lod; ///< 0 to 99; nothing for a name without a mark.

	friend bool operator==(const LodName &, const LodName &) = default;
};

/// Takes a name apart. The mark is "LOD" and a number of one or two digits, in upper or lower case, with "_", "-", "." or a blank between
/// them or without, where a word begins and ends: "Tree_LOD0", "lod1", "TrunkLOD2", "Tree-lod-1_leaves" have one; "Melod1" and "LOD100" have
/// none. The last mark counts.
LodName read_lod_name(std::string_view name);

/// What decides in which LODs a part of a model is drawn.
struct PartRange {
	std::string stem;       ///< LodName::stem of its node.
	std::optional<int> lod; ///< From its node's name, or from the nearest node above that has a mark.
	double begin = 0.0;     ///< Meters from which it is seen (visibility_range_begin), 0 for any;
	double end = 0.0;       ///< and up to which, 0 for any.
};

/// A level of detail of a model.
struct ModelLod {
	std::optional<double> distance; ///< Meters from which it is drawn; nothing where the scene does not say.
	std::vector<std::size_t> parts; ///< Indexes, ascending.

	friend bool operator==(const ModelLod &, const ModelLod &) = default;
};

/// Sorts the parts of a model into LODs, the finest first. At least one LOD for any part; none has no parts.
///
/// Where a part has a number, numbers decide: an LOD for each that occurs, in ascending order. A part without one counts as number 0 if a
/// numbered part has the same stem, else it belongs to all. An LOD begins at the largest `begin` of its numbered parts, if that is above 0.
///
/// Otherwise the ranges decide: an LOD from each distance on at which parts come or go, as long as something is drawn there. What ends for good is drawn
/// on: how far a layer is seen is the layer's business.
std::vector<ModelLod> model_lods(std::span<const PartRange> parts);

/// Meters from which the LOD of this index is drawn if nobody says so, for a model whose box has a diagonal of `size` meters: 0 for the first.
/// Each next one begins at about half the size on the screen.
double usual_lod_distance(double size, std::size_t lod);

} // namespace thicket
