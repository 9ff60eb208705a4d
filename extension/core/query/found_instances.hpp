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

/// The result of a query, in the query's order. It keeps references to the tiles of the instances,
/// so later changes to the world do not affect it. A PlacedInstance is assembled only on access.
/// Most callers only read IDs and positions, and complete instances would take five times the
/// memory.
class FoundInstances {
public:
	std::size_t size() const { return refs_.size(); }
	bool empty() const { return refs_.empty(); }
	void clear();

	// These methods return properties of the instance at index `i`.
	std::uint64_t id(std::size_t i) const { return refs_[i].id; }
	std::uint32_t layer(std::size_t i) const;
	std::uint32_t mesh(std::size_t i) const;
	glm::dvec3 position(std::size_t i) const; ///< Returns a position in world meters.
	PlacedInstance operator[](std::size_t i) const;

	/// Replaces `r_found` with all instances. Throws std::bad_alloc.
	void read_all(std::vector<PlacedInstance> &r_found) const;

	// The functions below are for queries only. They throw std::bad_alloc.

	/// Refers to an instance: its part and its index in that part.
	struct Ref {
		std::uint64_t id = 0;
		std::uint32_t part = 0;
		std::uint32_t index = 0;
	};

	/// Registers a mesh of a tile as a part to which refs may point. Returns the index of the part.
	std::uint32_t add_part(
			std::shared_ptr<const CompactMesh> content, glm::dvec3 origin, std::uint32_t layer, std::uint32_t mesh);
	void reserve(std::size_t more) { refs_.reserve(refs_.size() + more); }
	void add(const Ref &ref) { refs_.push_back(ref); }
	void add(const PlacedInstance &by_hand);

	/// Sorts the instances from index `first` on by ID. All of them must be generated instances of
	/// one layer. Sorting takes O(n) time if they are close together, as in a typical query, and
	/// otherwise O(n log n).
	void sort_from(std::size_t first);

	/// Removes the instances from index `first` on for which `accepts` returns false. `accepts` is
	/// called in order.
	template <class Accepts>
	void keep_from(std::size_t first, const Accepts &accepts) {
		std::size_t kept_count = first;
		for (std::size_t i = first; i < size(); ++i) {
			if (accepts((*this)[i])) {
				refs_[kept_count++] = refs_[i];
			}
		}
		refs_.resize(kept_count);
	}

private:
	/// The value of Ref::part for hand-placed instances, which are in no tile.
	static constexpr std::uint32_t by_hand = 0xffffffff;

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
