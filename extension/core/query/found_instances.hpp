#pragma once

#include "core/placement/kept_tile.hpp"
#include "core/query/placed_instance.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// What a query has found, as it stood then and in the query's order. Holds the tiles in which it stands, and puts an instance together
/// when somebody looks at it: most ask for ids and positions, and an instance as a whole takes five times the memory.
class FoundInstances {
public:
	std::size_t size() const { return refs_.size(); }
	bool empty() const { return refs_.empty(); }
	void clear();

	// Of the instance with this index.
	std::uint64_t id(std::size_t i) const { return refs_[i].id; }
	std::uint32_t layer(std::size_t i) const;
	std::uint32_t mesh(std::size_t i) const;
	glm::dvec3 position(std::size_t i) const; ///< World meters.
	PlacedInstance operator[](std::size_t i) const;

	/// Replaces `r_found` by all of them. Throws std::bad_alloc.
	void read_all(std::vector<PlacedInstance> &r_found) const;

	// For queries. They throw std::bad_alloc.

	/// An instance in a tile.
	struct Ref {
		std::uint64_t id = 0;
		std::uint32_t part = 0;
		std::uint32_t index = 0;
	};

	/// What follows may stand in this mesh of a tile. Returns the number of the part.
	std::uint32_t add_part(
			std::shared_ptr<const KeptMesh> content, glm::dvec3 origin, std::uint32_t layer, std::uint32_t mesh);
	void reserve(std::size_t more) { refs_.reserve(refs_.size() + more); }
	void add(const Ref &ref) { refs_.push_back(ref); }
	void add(const PlacedInstance &by_hand);

	/// Sorts those from this one on, which are of one layer and in tiles, by id. O(n) where they stand close together, as what a query
	/// finds mostly does.
	void sort_from(std::size_t first);

	/// Leaves out those from `first` on that `accepts` refuses; asks in their order.
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
	static constexpr std::uint32_t by_hand = 0xffffffff; ///< The part of what lies in no tile.

	struct Part {
		std::shared_ptr<const KeptMesh> content;
		glm::dvec3 origin{0.0};
		std::uint32_t layer = 0;
		std::uint32_t mesh = 0;
	};

	std::vector<Part> parts_;
	std::vector<Ref> refs_;
	std::vector<PlacedInstance> placed_;
};

} // namespace thicket
