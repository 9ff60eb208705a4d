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

/// The instances of one mesh in one tile, in a compact form that is kept as long as it may be needed. Instead of the
/// floats, it stores the data from which they are computed. It reproduces its original MeshInstances bit for bit, in
/// the same order.
///
/// An instance takes 20 bytes if its layer is upright, 32 if it follows the ground, and 8 more if its color or its variation follows a
/// source. Instances that the layer's settings do not generate (hand-placed ones) come first and are stored as floats.
class CompactMesh {
public:
	CompactMesh() = default;

	/// Compacts a mesh that was generated from `settings`. A mesh without normals was not generated from settings, so
	/// it is stored as floats. Throws std::bad_alloc.
	CompactMesh(const MeshInstances &mesh, std::shared_ptr<const LayerSettings> settings);

	/// Stores `first` as floats, followed by the given instances of `base`, ascending. Throws std::bad_alloc.
	CompactMesh(const MeshInstances &first, const CompactMesh &base, std::span<const std::uint32_t> standing);

	std::size_t size() const { return positions_.size(); }
	std::size_t stride() const { return stride_; }
	std::uint64_t id(std::size_t i) const {
		if (i < as_they_are()) {
			return ids_[i];
		}
		const std::uint32_t cell = cells_[i - as_they_are()];
		return first_id_ + (std::uint64_t{cell >> y_bits & cell_mask} << 24) + (cell & cell_mask);
	}

	/// The index of the instance with this id; `size` if there is none.
	std::size_t find(std::uint64_t id) const;

	/// Relative to the tile's origin, in meters.
	std::span<const glm::vec3> positions() const { return positions_; }
	std::span<const std::uint32_t> ranks() const { return ranks_; }

	// See MeshInstances for the meaning of these values.
	glm::vec3 min() const { return min_; }
	glm::vec3 max() const { return max_; }
	float max_scale() const { return max_scale_; }

	/// Writes the transform of an instance.
	void read_transform(std::size_t i, std::span<float, transform_floats> r_floats) const;

	/// Writes all floats of an instance, `stride` of them.
	void read(std::size_t i, std::span<float> r_floats) const;

	/// Writes the floats of several instances, one after the other.
	void read(std::span<const std::uint32_t> order, std::span<float> r_floats) const;

	/// Writes the floats of all instances.
	void read_all(std::span<float> r_floats) const;

	/// True if an instance has the same id and bit-identical floats as an instance of a different mesh of the same tile
	/// and layer.
	bool same(std::size_t i, const CompactMesh &other, std::size_t j) const;

	/// Bytes of memory, without the object itself.
	std::size_t bytes() const;

private:
	/// A cell's position in its tile, packed together with the signs of x and z of the normal.
	static constexpr std::uint32_t y_bits = 15;
	static constexpr std::uint32_t cell_mask = (1u << y_bits) - 1;
	static constexpr std::uint32_t x_is_negative = 1u << 30;
	static constexpr std::uint32_t z_is_negative = 1u << 31;

	std::size_t as_they_are() const { return ids_.size(); }
	bool find_cells(const MeshInstances &mesh);
	void keep_as_it_is(const MeshInstances &mesh);
	void keep_sources(const MeshInstances &mesh);
	void measure(float max_scale);
	glm::vec3 normal_of(std::size_t source) const;
	float read_basis(std::size_t i, std::span<float, transform_floats> r_floats) const;
	void read_behind(std::size_t i, float scale, std::span<float> r_floats) const;
	template <class IndexOf>
	void read_many(std::size_t count, const IndexOf &index_of, std::span<float> r_floats) const;

	std::shared_ptr<const LayerSettings> settings_;
	std::size_t stride_ = transform_floats;
	std::uint64_t first_id_ = 0; ///< The id of the corner of the cells.
	glm::vec3 min_{0.0f};
	glm::vec3 max_{0.0f};
	float max_scale_ = 0.0f;

	UnfilledVector<glm::vec3> positions_;
	std::vector<std::uint32_t> ranks_;

	// For the instances that the settings generate.
	UnfilledVector<std::uint32_t> cells_;
	std::vector<glm::vec3> normals_;     ///< Empty if the layer is upright: the signs are enough then.
	std::vector<InstanceShares> shares_; ///< Empty if no source is known.

	// For the instances before them.
	std::vector<std::uint64_t> ids_;
	std::vector<float> floats_;
};

/// All instances in one tile of one layer, in compact form; see TileInstances.
struct CompactTile {
	glm::dvec3 origin{0.0};
	std::vector<CompactMesh> meshes;
	TileCounts counts;

	CompactTile() = default;

	/// Throws std::bad_alloc.
	CompactTile(const TileInstances &tile, const std::shared_ptr<const LayerSettings> &settings);
};

/// Converts a compact mesh back to floats. The result lacks the normals, so it cannot be compacted again. Throws
/// std::bad_alloc.
MeshInstances expanded(const CompactMesh &mesh);
TileInstances expanded(const CompactTile &tile);

} // namespace thicket
