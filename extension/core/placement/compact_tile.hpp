#pragma once

#include "core/base/unfilled.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/tile_instances.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The instances of one mesh in one tile, in a compact form for long-term storage. A compact mesh
/// stores the data from which the floats are computed, and reproduces the floats of the original
/// MeshInstances bit for bit, in the same order.
///
/// An instance takes 20 bytes, 12 more if its layer is aligned to the ground, and 4 more for
/// each of color, variation and scale that depends on a source. Hand-placed instances come first and are stored as
/// floats.
class CompactMesh {
public:
	CompactMesh() = default;

	/// Compacts a mesh that was generated from `settings` in a tile with this origin. A mesh without
	/// normals is stored as floats. Throws std::bad_alloc.
	CompactMesh(const MeshInstances &mesh, std::shared_ptr<const LayerSettings> settings, const glm::dvec3 &origin);

	/// Stores `first` as floats, followed by the instances of `base` at the indices `retained`,
	/// which are ascending. Throws std::bad_alloc.
	CompactMesh(const MeshInstances &first, const CompactMesh &base, std::span<const std::uint32_t> retained);

	std::size_t size() const { return positions_.size(); }
	std::size_t stride() const { return stride_; }
	std::uint64_t id(std::size_t i) const {
		if (i < stored_count()) {
			return ids_[i];
		}
		const std::uint32_t cell = cells_[i - stored_count()];
		return first_id_ + (std::uint64_t{cell >> y_bits & cell_mask} << 24) + (cell & cell_mask);
	}

	/// Returns the index of the instance with this id, or size() if there is none.
	std::size_t find(std::uint64_t id) const;

	/// Returns the positions in meters relative to the tile's origin.
	std::span<const glm::vec3> positions() const { return positions_; }
	std::span<const std::uint32_t> ranks() const { return ranks_; }

	// See MeshInstances for the meaning of these values.
	glm::vec3 min() const { return min_; }
	glm::vec3 max() const { return max_; }
	float max_scale() const { return max_scale_; }

	/// Writes the transform of an instance.
	void read_transform(std::size_t i, std::span<float, transform_floats> r_floats) const;

	/// Writes all stride() floats of an instance.
	void read(std::size_t i, std::span<float> r_floats) const;

	/// Writes the floats of the instances at the indices `order`, one after the other.
	void read(std::span<const std::uint32_t> order, std::span<float> r_floats) const;

	/// Writes the floats of all instances.
	void read_all(std::span<float> r_floats) const;

	/// Returns true if instance `i` has the same id and bit-identical floats as instance `j` of
	/// `other`, a mesh of the same tile and layer.
	bool same(std::size_t i, const CompactMesh &other, std::size_t j) const;

	/// Returns the used memory in bytes, without this object itself.
	std::size_t bytes() const;

private:
	/// Bit layout of `cells_`: the offset of an instance's cell from the lowest cell of the mesh,
	/// and the signs of the normal's x and z.
	static constexpr std::uint32_t y_bits = 15;
	static constexpr std::uint32_t cell_mask = (1u << y_bits) - 1;
	static constexpr std::uint32_t x_is_negative = 1u << 30;
	static constexpr std::uint32_t z_is_negative = 1u << 31;

	std::size_t stored_count() const { return ids_.size(); }
	bool find_cells(const MeshInstances &mesh);
	void store_floats(const MeshInstances &mesh);
	void store_sources(const MeshInstances &mesh);
	void measure(float max_scale);
	glm::vec3 normal_of(std::size_t source) const;
	SourceFractions fractions_of(std::size_t source) const;
	double scale_number_of(std::size_t i) const;
	float read_basis(std::size_t i, std::span<float, transform_floats> r_floats) const;
	void read_instance_data(std::size_t i, float scale, std::span<float> r_floats) const;
	template <class IndexOf>
	void read_many(std::size_t count, const IndexOf &index_of, std::span<float> r_floats) const;

	std::shared_ptr<const LayerSettings> settings_;
	UpField up_;
	std::size_t stride_ = transform_floats;
	std::uint64_t first_id_ = 0; ///< Id of the lowest cell of the mesh.
	glm::vec3 min_{0.0f};
	glm::vec3 max_{0.0f};
	float max_scale_ = 0.0f;

	UnfilledVector<glm::vec3> positions_;
	std::vector<std::uint32_t> ranks_;

	// Cells and signs of the generated instances.
	UnfilledVector<std::uint32_t> cells_;
	/// Empty if the layer is upright, because the signs in `cells_` suffice.
	std::vector<glm::vec3> normals_;
	// The fractions of SourceFractions. A list is empty if its source is not known.
	std::vector<float> color_fractions_;
	std::vector<float> variation_fractions_;
	std::vector<float> scale_fractions_;

	// Ids of the instances that are stored as floats. These instances come before all generated
	// ones.
	std::vector<std::uint64_t> ids_;
	std::vector<float> floats_;
};

/// All instances in one tile of one layer, in compact form; see TileInstances.
struct CompactTile {
	glm::dvec3 origin{0.0};
	std::vector<CompactMesh> meshes;
	TileCounts counts;

	CompactTile() = default;

	/// Compacts a tile. Throws std::bad_alloc.
	CompactTile(const TileInstances &tile, const std::shared_ptr<const LayerSettings> &settings);
};

/// Converts compact instances back to floats. The result has no normals, so it cannot be compacted
/// again. Throws std::bad_alloc.
MeshInstances expanded(const CompactMesh &mesh);
TileInstances expanded(const CompactTile &tile);

} // namespace thicket
