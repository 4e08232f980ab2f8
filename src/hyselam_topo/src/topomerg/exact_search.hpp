// Branch and bound over the names: one name after the other gets its final vertices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "hyselam_common/assignment.hpp"
#include "merge_terms.hpp"
#include "solutions.hpp"

namespace hyselam_topo::merging {

constexpr double kNever = hyselam::Assignment::kNotAllowed;  ///< loss of what is not allowed

inline std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

/// A set of vertices that a name may take as a whole.
struct CandidateSet {
  Vertices vertices;
  int anchor = 0;  ///< its first vertex by rank
};

/// The vertices of the name that is being built: those it has, and those that it may get.
struct Growth {
  int name = -1;
  Vertices has;
  PlaceSet open;
  // Where its centre may come to lie: in this circle.
  double x = 0.0, y = 0.0, radius = 0.0;
};

/// A place's view of the centre of what is being built.
struct Sight {
  double bearing = 0.0;  ///< to the middle of the circle
  double slack = kPi;    ///< either way to its rim
};

/// What a set of vertices has to do with the name that is being built.
struct GrownView {
  bool touches = false;
  bool may_touch = false;
  bool may_share_wall = false;
  bool placed = false;  ///< the set has a position
  Sight see;
  PlaceSet members;  ///< of the set
};

/// A vertex with too many sets to list them.
struct LooseAnchor {
  int anchor = 0;
  PlaceSet piece;   ///< that its sets are made of
  PlaceSet around;  ///< neighbours of its vertices, also those that are ranked above the anchor
  double area = 0.0;
};

/// What is known at one node of the search.
struct Node {
  double base = 0.0;                ///< lost among the names that have got their vertices
  double bound = 0.0;               ///< lost at least by any answer from here
  double table_bound = 0.0;         ///< the same as the table tells it; at most `bound`
  PlaceSet available;               ///< to names that have none and are not confirmed
  std::vector<int> alive;           ///< always-listed sets of available vertices
  std::vector<CandidateSet> extra;  ///< sets that are listed here only
  std::vector<LooseAnchor> loose;
  std::vector<int> rows;       ///< names of the rows of the table
  std::vector<int> row_of;     ///< of each name, -1: none
  std::vector<int> column_of;  ///< of each vertex, -1: none
  std::vector<double> cost;    ///< rows x (alive, then extra)
  hyselam::Assignment table;   ///< rows x available vertices

  std::size_t setCount() const { return alive.size() + extra.size(); }
};

/// A name that several others are joined to, and those of them that are not such a name themselves.
struct Group {
  int hub = 0;
  std::vector<int> names;  ///< with the hub
  /// Lost among them in any answer, if those of the busy vertices are taken by others.
  struct Least {
    PlaceSet taken;
    double loss = 0.0;
    bool exact = false;  ///< an answer that loses so little ...
    PlaceSet used;       ///< ... is made of these
  };
  std::vector<Least> least;
};

class ExactSearch {
 public:
  ExactSearch(const MatchProblem& problem, const MatchParams& params, const Terms& terms);
  Match run();
  /// What any answer loses, as far as so many nodes can tell; at least `known`.
  Group::Least leastLoss(std::uint64_t max_nodes, double known);

 private:
  struct Choice {
    double bound = 0.0;
    int set = -1;   ///< in the node's list, or
    int seed = -1;  ///< the anchor of sets that are not listed; both -1: no vertices
  };

  bool searchAll();
  void deepen(double known_fitness);
  std::vector<Group> findGroups() const;
  double leastOf(Group* group, const PlaceSet& taken) const;
  bool untouched(const Group& group, const Growth* growth) const;
  struct Sector {
    Heading heading;
    double low = 0.0;  ///< answers whose best heading is not within low .. high are left to others
    double high = 0.0;
    std::vector<Group> groups;
  };
  void listSectors(double start);
  void search(std::size_t depth, double known);
  void branch(Node* here, int name, std::size_t depth);
  void startFrom(int name, const Vertices& has, PlaceSet open, std::size_t depth, double known);
  void grow(const Growth& growth, std::size_t depth, double known);
  void close(int name, const Vertices& vertices, std::size_t depth, double known);
  void closeLast(int name, std::size_t depth, double known);
  void leaf();

  /// Fills the node and returns its bound; at least `base`. `growth` may be null.
  double bound(Node* node, const Growth* growth);
  void listOnce();
  void listSets(Node* node) const;
  void addLast(const Node& node, int name, int last, const double* before, double* now);
  void listRows(Node* node, int near, const std::vector<char>& late) const;
  double grownLoss(const Growth& growth) const;
  double emptyLoss(int name, const Growth* growth) const;
  GrownView viewOf(const Vertices& vertices, const Growth& growth) const;
  double looseLoss(int name, const LooseAnchor& loose, const Growth* growth) const;
  /// Of two names that are told to be joined, one of which is being built.
  double grownPairLoss(int name, std::size_t set, const Growth& growth);
  void addGrowth(int name, const Growth& growth, double* cost);
  /// What is lost of two names that are told to be joined and are not.
  double pairLoss(int i, int j) const { return pair_loss_[at(i * n_ + j)]; }
  /// The least of it if they share a wall.
  double wallLoss(int i, int j) const { return wall_loss_[at(i * n_ + j)]; }
  /// What a set of the node loses of a side through its doors: the same for all names that were
  /// told on the same side, so it is computed once.
  template <typename Compute>
  double rememberedDoors(int side, bool from_set, std::size_t set, Compute&& compute) {
    const std::size_t row = 2 * at(middle_of_[at(side)]) + (from_set ? 1 : 0);
    double& loss = door_losses_[row * sets_ + set];
    if (loss < 0.0) loss = compute();
    return loss;
  }
  bool mayShareWall(const PlaceSet& a, const PlaceSet& b) const;
  PlaceSet piece(std::size_t anchor, const PlaceSet& of) const;
  bool forEachSet(std::size_t anchor, const PlaceSet& piece, std::size_t limit,
                  const std::function<void(const Vertices&)>& visit) const;
  int sideBetween(int i, int j) const { return side_between_[at(i * n_ + j)]; }
  const Vertices& setOf(const Node& node, std::size_t number) const {
    return number < node.alive.size()
               ? listed_[static_cast<std::size_t>(node.alive[number])].vertices
               : node.extra[number - node.alive.size()].vertices;
  }
  int anchorOf(const Node& node, std::size_t number) const {
    return number < node.alive.size() ? listed_[static_cast<std::size_t>(node.alive[number])].anchor
                                      : node.extra[number - node.alive.size()].anchor;
  }
  /// Of two names that have no vertices yet, the other one bears the loss if they are not joined.
  bool leads(int i, int j) const {
    const int a = told_edges_[static_cast<std::size_t>(i)];
    const int b = told_edges_[static_cast<std::size_t>(j)];
    return a != b ? a > b : i < j;
  }
  void locate(Growth* growth) const;
  void keepReachable(Growth* growth) const;
  double exactLoss(int name, const Vertices& vertices) const;
  double relationsLoss(int name, const Vertices& vertices) const;
  void note(double bound) { unexplored_ = std::min(unexplored_, bound); }
  int nextName(const Node& node) const;
  std::vector<Choice> choicesOf(const Node& node, int name) const;
  std::size_t taken(const Node& node) const;
  bool hopeless(double bound, std::size_t at_least) const;
  bool stopped();
  Node& node(std::size_t depth);

  const MatchProblem& problem_;
  const MatchParams& params_;
  const Terms& terms_;
  const int n_;
  const int m_;
  // Vertices are ranked, those with most neighbours first: sets without the few that lead to many
  // are small pieces of the map. The first vertex of a set by rank is its anchor.
  std::vector<PlaceSet> lower_;  ///< of each vertex, those ranked below
  std::vector<CandidateSet> listed_;
  PlaceSet busy_;                       ///< vertices with many neighbours
  std::vector<int> not_always_listed_;  ///< anchors with too many sets
  std::vector<char> has_fixed_;
  PlaceSet fixed_;
  Heading heading_;
  double slack_ = 0.0;  ///< of a heading that is known
  std::vector<Sector> all_sectors_;
  double sector_low_ = 0.0;
  double sector_high_ = 0.0;

  std::vector<Vertices> closed_;
  std::vector<char> is_closed_;
  std::vector<int> closed_list_;
  std::vector<int> owner_;                     ///< of each vertex, -1: free
  std::vector<int> told_edges_;                ///< of each name
  std::vector<int> side_between_;              ///< names x names, number in problem.sides or -1
  std::vector<double> pair_loss_, wall_loss_;  ///< names x names, of those told to be joined
  std::vector<std::vector<int>> led_by_;       ///< of each name: see leads()
  std::vector<int> middle_of_;                 ///< of each side: number of its direction as told
  std::size_t middles_ = 0;                    ///< different directions
  /// Names x listed sets, for each number of names that have got their vertices: what the name
  /// would lose with that set, alone and with them.
  std::vector<std::vector<double>> losses_;
  std::vector<int> told_closed_;  ///< of each name: told to be joined to as many closed ones
  PlaceSet free_;
  std::size_t taken_ = 0;
  double base_ = 0.0;

  // Of the node whose bound is computed, of each set:
  std::vector<char> late_;         ///< of each name: of an untouched group
  std::vector<Contact> contacts_;  ///< with the name that has last got its vertices
  std::vector<double> bearings_;   ///< from the set to that name
  std::vector<GrownView> views_;
  std::vector<double> touch_costs_;  ///< of a name that is not told to be joined to what grows
  std::vector<int> columns_;         ///< of the table
  std::vector<double>
      door_losses_;  ///< (2 x directions) x sets, see rememberedDoors(); -1: not yet
  std::size_t sets_ = 0;
  std::vector<char> lonely_;  ///< touches no available vertex: 1 but shares a wall with one, 2 none

  std::deque<Node> nodes_;
  std::vector<Group>* groups_ = nullptr;  ///< of the sector
  Solutions solutions_;
  std::uint64_t max_nodes_ = std::numeric_limits<std::uint64_t>::max();
  Stopwatch watch_;
  std::uint64_t visited_ = 0;
  bool stopped_ = false;
  double proven_ = 0.0;  ///< no answer loses less
  double unexplored_ = std::numeric_limits<double>::infinity();
};

}  // namespace hyselam_topo::merging
