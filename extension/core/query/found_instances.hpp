#pragma once

#include "core/placement/compact_tile.hpp"
#include "core/query/placed_instance.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The result of a query, as the instances were placed at that time and in the query's order. The result refers to the
/// tiles of the instances, and assembles an instance only when it is read. Most callers only read ids and positions,
/// and a complete instance takes five times the memory.
class FoundInstances {
public:
	std::size_t size() const { return refs_.size(); }
	bool empty() const { return refs_.empty(); }
	void clear();

	// For the instance with this index.
	std::uint64_t id(std::size_t i) const { return refs_[i].id; }
	std::uint32_t layer(std::size_t i) const;
	std::uint32_t mesh(std::size_t i) const;
	glm::dvec3 position(std::size_t i) const; ///< World meters.
	PlacedInstance operator[](std::size_t i) const;

	/// Replaces `r_found` by all of them. Throws std::bad_alloc.
	void read_all(std::vector<PlacedInstance> &r_found) const;

	// For use by queries. These throw std::bad_alloc.

	/// An instance in a tile.
	struct Ref {
		std::uint64_t id = 0;
		std::uint32_t part = 0;
		std::uint32_t index = 0;
	};

	/// Registers a mesh of a tile to which later refs may point. Returns the number of the part.
	std::uint32_t add_part(
			std::shared_ptr<const CompactMesh> content, glm::dvec3 origin, std::uint32_t layer, std::uint32_t mesh);
	void reserve(std::size_t more) { refs_.reserve(refs_.size() + more); }
	void add(const Ref &ref) { refs_.push_back(ref); }
	void add(const PlacedInstance &by_hand);

	/// Sorts the instances from this index on by id. They must all be of one layer and in tiles. O(n) if the instances
	/// lie close together, as in the result of a usual query.
	void sort_from(std::size_t first);

	/// Removes the instances from `first` on that `accepts` refuses. Calls `accepts` in their order.
	template <class Accepts>
	void keep_from(std::size_t first, const Accepts &accepts) {
		std::size_t kept = first;
		for (std::size_t i = first; i < size(); ++i) {
			if (accepts((*this)[i])) {
				refs_[kept++] = refs_[i];
			}
		}
		refs_.resize(kept);
	}

private:
	static constexpr std::uint32_t by_hand = 0xffffffff; ///< The part of instances that lie in no tile.

	struct Part {
		std::shared_ptr<const CompactMesh> content;
		glm::dvec3 origin{0.0};
		std::uint32_t layer = 0;
		std::uint32_t mesh = 0;
	};

	std::vector<Part> parts_;
	std::vector<Ref> refs_;
	std::vector<PlacedInstance> placed_;
};

} // namespace thicket
