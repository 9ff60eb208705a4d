#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thicket {

/// A node's name, split into its stem and the LOD number that artists append.
struct LodName {
	/// The name without the mark and its separator, such as "Trunk" for "Trunk_LOD1". May be empty.
	std::string stem;
	std::optional<int> lod; ///< 0 to 99; none for a name without a mark.

	friend bool operator==(const LodName &, const LodName &) = default;
};

/// Splits a name at its LOD mark: "LOD", in upper or lower case, and a number of one or two digits.
/// "_", "-", "." or a space may separate the two. The mark must be a whole word: "Tree_LOD0",
/// "lod1", "TrunkLOD2" and "Tree-lod-1_leaves" have one, but "Melod1" and "LOD100" have none. If
/// there are several marks, the last one applies.
LodName read_lod_name(std::string_view name);

/// The properties of a model's part that determine in which LODs it is drawn.
struct PartRange {
	std::string stem;       ///< LodName::stem of the part's node.
	std::optional<int> lod; ///< From the name of its node, or of the nearest ancestor with a mark.
	/// Distance in meters from which the part is visible (visibility_range_begin); 0 for no limit.
	double begin = 0.0;
	double end = 0.0; ///< Distance in meters up to which the part is visible; 0 for no limit.
};

/// An LOD of a model.
struct ModelLod {
	/// Distance in meters from which the LOD is drawn; none if the scene does not specify it.
	std::optional<double> distance;
	std::vector<std::size_t> parts; ///< Indices of its parts, ascending.

	friend bool operator==(const ModelLod &, const ModelLod &) = default;
};

/// Assigns the parts of a model to LODs, the finest first. Returns no LODs if there are no parts.
///
/// If any part has a number, the numbers determine the LODs: each number that occurs becomes an
/// LOD, in ascending order. A part without a number belongs to LOD 0 if a numbered part has the
/// same stem; otherwise it belongs to all LODs. An LOD begins at the largest `begin` of its
/// numbered parts, if that is above 0.
///
/// Otherwise, the ranges determine the LODs: an LOD begins at each distance at which parts appear
/// or disappear, if any part is drawn there. The last LOD has no end, because the layer's settings
/// determine how far it is visible.
std::vector<ModelLod> model_lods(std::span<const PartRange> parts);

/// Returns the default distance in meters from which the LOD at index `lod` is drawn, which is 0
/// for the first LOD. `size` is the diagonal of the model's bounding box in meters. Each following
/// LOD begins at twice the distance of the LOD before it, because the model appears half as large
/// there.
double usual_lod_distance(double size, std::size_t lod);

} // namespace thicket
