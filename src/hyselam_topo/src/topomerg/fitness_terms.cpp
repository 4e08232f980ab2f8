#include "fitness_terms.hpp"

#include <algorithm>

namespace hyselam_topo::merging {
namespace {

/// Of the vectors through doors on the same side, their product is more than this.
constexpr double kParallel = 0.8;
/// More than any deviation.
constexpr double kNoDoor = 4.0;
/// What is left of a place in a row if one door is missing before or behind it, for each one.
constexpr double kOneMissing = 0.4;
/// Doors that are less apart are counted as neither before nor behind each other [m].
constexpr double kBeside = 0.3;
}  // namespace

void VertexSet::add(const MatchProblem& problem, std::size_t vertex) {
  members.insert(vertex);
  neighbors |= problem.neighbors[vertex];
  neighbors -= members;
  if (!problem.across_walls.empty()) {
    across_walls |= problem.across_walls[vertex];
    across_walls -= members;
  }
  area += problem.area[vertex];
  weight += problem.weight[vertex];
  sx += problem.weight[vertex] * problem.x[vertex];
  sy += problem.weight[vertex] * problem.y[vertex];
  ++count;
}

FitnessTerms::FitnessTerms(const MatchProblem& problem_in, const FitnessParams& params)
    : problem(problem_in),
      by_doors(params.sides == SideRule::kDoors && problem_in.has_doors),
      absent_share(params.absent_share),
      sides_of(problem_in.nameCount()),
      clauses_of(problem_in.nameCount()),
      has_evidence(problem_in.nameCount(), 0),
      heading_is_exact_(problem_in.heading.has_value()) {
  if (by_doors && !problem.across_walls.empty()) closed_door_credit = params.closed_door_credit;
  for (std::size_t s = 0; s < problem.sides.size(); ++s) {
    sides_of[static_cast<std::size_t>(problem.sides[s].from)].push_back(static_cast<int>(s));
    sides_of[static_cast<std::size_t>(problem.sides[s].to)].push_back(static_cast<int>(s));
  }
  const std::size_t m = problem.vertexCount();
  for (std::size_t i = 0; i < problem.nameCount() && !problem.evidence.empty(); ++i)
    for (std::size_t v = 0; v < m; ++v)
      if (problem.evidence[i * m + v] > 0.0) has_evidence[i] = 1;
  listClauses(params);
  shareWeights(params);
}

void FitnessTerms::listClauses(const FitnessParams& params) {
  using What = Clause::What;
  for (const MatchProblem::Relation& r : problem.relations)
    clauses.push_back({What::kRelation,
                       r.kind,
                       r.a,
                       r.b,
                       r.c,
                       r.denied,
                       {},
                       0.0,
                       r.side_angle,
                       r.position,
                       r.looked});
  if (by_doors && params.orders > 0.0)
    for (const MatchProblem::DescribedOrder& o : problem.orders)
      clauses.push_back(
          {What::kOrder, {}, o.first, o.then, o.from, false, o.turn, 0.0, 0.0, {}, {}, o.strength});
  if (by_doors && params.numbers > 0.0) {
    for (const MatchProblem::DescribedNumber& n : problem.numbers) {
      const bool rank = n.rank != 0;
      clauses.push_back({rank ? What::kNumber : What::kDistance,
                         {},
                         n.to,
                         n.from,
                         -1,
                         false,
                         n.turn,
                         rank ? n.rank : n.distance,
                         n.side_angle,
                         n.position});
    }
  }
  for (std::size_t k = 0; k < clauses.size(); ++k)
    for (const int i : {clauses[k].a, clauses[k].b, clauses[k].c})
      if (i >= 0) clauses_of[static_cast<std::size_t>(i)].push_back(static_cast<int>(k));
}

std::vector<FitnessTerms::Statements> FitnessTerms::countStatements(
    const FitnessParams& params) const {
  const std::size_t n = problem.nameCount();
  std::size_t here = 0, areas = 0, parts = 0, kinds = 0, ranks = 0, doors = 0, words = 0, edges = 0;
  for (const MatchProblem::NameAttributes& described : problem.attributes) {
    here += !described.elsewhere;
    areas += described.area > 0.0;
    parts += described.parts > 0;
    kinds += described.kind.has_value();
    doors += described.doors > 0;
    words += described.size_word.has_value();
  }
  const bool ordered = by_doors && params.orders > 0.0;
  for (const MatchProblem::DescribedSide& s : problem.sides)
    ranks += ordered && s.before + s.after > 0;
  const std::size_t pairs = here * (here - (here > 0 ? 1 : 0)) / 2;  // N_e
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) edges += problem.areConnected(i, j);
  const bool shares = params.weighting == Weighting::kShares;
  // The weight of orders is for pairs and for ranks, half of it each.
  return {{Term::kVertex, params.vertices, here},
          {Term::kArea, params.areas, areas},
          {Term::kEdge, params.edges, shares ? pairs : edges},
          {Term::kSide, params.orientations, problem.sides.size()},
          {Term::kRelation, params.relations, problem.relations.size()},
          {Term::kParts, params.parts, parts},
          {Term::kKind, params.kinds, kinds},
          {Term::kEvidence, params.evidence,
           static_cast<std::size_t>(std::count(has_evidence.begin(), has_evidence.end(), 1))},
          {Term::kOrder, 0.5 * params.orders, ordered ? problem.orders.size() : 0},
          {Term::kRank, 0.5 * params.orders, ranks},
          {Term::kNumber, params.numbers, by_doors ? problem.numbers.size() : 0},
          {Term::kDoors, params.doors, doors},
          {Term::kSizeWord, params.size_words, words},
          {Term::kPiece, params.pieces, shares ? 0 : problem.vertexCount()}};
}

void FitnessTerms::shareWeights(const FitnessParams& params) {
  const std::vector<Statements> all = countStatements(params);
  const bool shares = params.weighting == Weighting::kShares;
  double sum = 0.0;
  for (const Statements& s : all) {
    if (s.count > 0) sum += shares ? s.weight : s.weight * static_cast<double>(s.count);
  }
  std::size_t edges = 0;  // of the map: as many connections that nobody told of at most
  for (const PlaceSet& neighbors : problem.neighbors) edges += neighbors.size();
  const double undescribed = params.edges * (1.0 - params.undescribed_edge_credit);
  if (!shares) sum += undescribed * 0.5 * static_cast<double>(edges);
  for (const Statements& s : all) {
    const double share = shares ? s.weight / static_cast<double>(s.count) : s.weight;
    weights_[static_cast<std::size_t>(s.term)] = s.count == 0 || sum <= 0.0 ? 0.0 : share / sum;
  }
  undescribed_edge = shares      ? weight(Term::kEdge) * (1.0 - params.undescribed_edge_credit)
                     : sum > 0.0 ? undescribed / sum
                                 : 0.0;
  scale_ = shares ? 0.0 : sum;
}

double FitnessTerms::unaryLoss(int name, const VertexSet& v) const {
  const auto i = static_cast<std::size_t>(name);
  const MatchProblem::NameAttributes& described = problem.attributes[i];
  if (v.empty()) {
    if (described.elsewhere) return 0.0;
    double loss = weight(Term::kVertex) + (described.needs_place ? 1.0 : 0.0);
    if (described.area > 0.0) loss += absentLoss(Term::kArea);
    if (described.parts > 0) loss += absentLoss(Term::kParts);
    if (described.kind) loss += absentLoss(Term::kKind);
    if (described.doors > 0) loss += absentLoss(Term::kDoors);
    if (described.size_word) loss += absentLoss(Term::kSizeWord);
    return has_evidence[i] ? loss + absentLoss(Term::kEvidence) : loss;
  }
  double loss = described.parts > 0 ? 0.0 : weight(Term::kPiece) * (v.count - 1);
  if (described.area > 0.0)
    loss +=
        weight(Term::kArea) * std::abs(described.area - v.area) / std::max(described.area, v.area);
  if (described.parts > 0 && weight(Term::kParts) > 0.0)
    loss += weight(Term::kParts) * std::abs(described.parts - v.count) /
            static_cast<double>(std::max(described.parts, v.count));
  if (described.kind && weight(Term::kKind) > 0.0) {
    double right = 0.0, all = 0.0;
    v.members.forEach([&](std::size_t m) {
      all += problem.area[m];
      if (problem.kind[m] == *described.kind) right += problem.area[m];
    });
    loss += weight(Term::kKind) * (all > 0.0 ? 1.0 - right / all : 1.0);
  }
  if (described.doors > 0 && weight(Term::kDoors) > 0.0) {
    const int doors = doorCount(v);
    loss += weight(Term::kDoors) * std::abs(described.doors - doors) /
            static_cast<double>(std::max(described.doors, doors));
  }
  if (described.size_word)
    loss += weight(Term::kSizeWord) * (1.0 - sizeWordValue(*described.size_word, v));
  if (has_evidence[i]) {
    double best = 0.0;
    v.members.forEach([&](std::size_t m) {
      best = std::max(best, problem.evidence[i * problem.vertexCount() + m]);
    });
    loss += weight(Term::kEvidence) * (1.0 - best);
  }
  return loss;
}

int FitnessTerms::doorCount(const VertexSet& v) const {
  int doors = 0;
  v.members.forEach([&](std::size_t m) {
    for (const MatchProblem::Passage& p : problem.passages[m]) doors += !v.members.contains(p.to);
  });
  return doors;
}

/// Twice or half the usual size is certainly large or small.
double FitnessTerms::sizeWordValue(SizeWord word, const VertexSet& v) const {
  if (!(problem.typical_area > 0.0 && v.area > 0.0)) return 0.5;
  const double steps = std::log2(v.area / problem.typical_area);
  return std::clamp(0.5 + (word == SizeWord::kLarge ? steps : -steps), 0.0, 1.0);
}

double FitnessTerms::doorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                              const PlaceSet& to, Heading heading) const {
  double least = kNoDoor;
  // Seen from the smaller set: it has fewer passages.
  const bool turned = from.size() > to.size();
  const PlaceSet &here = turned ? to : from, &there = turned ? from : to;
  const auto consider = [&](const MatchProblem::Passage& p) {
    const double bearing = turned ? wrapAngleOnce(p.bearing + kPi) : p.bearing;
    least = std::min(least, deviation(side, bearing, heading));
  };
  forEachPassage(here, there, consider);
  if (least < kNoDoor) return throughDoor(side, least);
  forEachWall(here, there, consider);
  return least < kNoDoor ? throughWall(side, least) : sideWeight(side);
}

double FitnessTerms::minDoorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                                 const PlaceSet& to, Heading heading) const {
  const double doors = doorLoss(side, from, to, heading);
  if (!(closed_door_credit > 0.0)) return doors;
  double least = kNoDoor;
  forEachWall(from, to, [&](const MatchProblem::Passage& p) {
    least = std::min(least, deviation(side, p.bearing, heading));
  });
  return least < kNoDoor ? std::min(doors, throughWall(side, least)) : doors;
}

int FitnessTerms::missingInRow(const MatchProblem::DescribedSide& side,
                               const MatchProblem::Passage& own, const PlaceSet& from) const {
  const double c = std::cos(side.turn), s = std::sin(side.turn);
  const double ax = c * own.dx - s * own.dy, ay = s * own.dx + c * own.dy;
  int before = 0, after = 0;
  const auto count = [&](const MatchProblem::Passage& other) {
    if (other.dx * own.dx + other.dy * own.dy < kParallel) return;
    const double ahead = ax * (other.x - own.x) + ay * (other.y - own.y);
    before += ahead < -kBeside;
    after += ahead > kBeside;
  };
  from.forEach([&](std::size_t v) {
    for (const MatchProblem::Passage& other : problem.passages[v])
      if (!from.contains(other.to)) count(other);
    if (closed_door_credit > 0.0)
      for (const MatchProblem::Passage& other : problem.walls[v])
        if (!from.contains(other.to)) count(other);
    if (!problem.gaps.empty())
      for (const MatchProblem::Passage& gap : problem.gaps[v]) count(gap);
  });
  return std::max(0, side.before - before) + std::max(0, side.after - after);
}

double FitnessTerms::rankShare(const MatchProblem::DescribedSide& side, int missing) const {
  return missing >= side.before + side.after ? 1.0 : 1.0 - std::pow(kOneMissing, missing);
}

double FitnessTerms::rankLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                              const PlaceSet& to) const {
  if (side.before + side.after == 0 || rankWeight(side) <= 0.0) return 0.0;
  int least = side.before + side.after;
  forEachDoor(from, to, [&](const MatchProblem::Passage& own) {
    least = std::min(least, missingInRow(side, own, from));
  });
  return rankWeight(side) * rankShare(side, least);
}

double FitnessTerms::absentSideLoss(const MatchProblem::DescribedSide& side, const VertexSet& from,
                                    const VertexSet& to) const {
  const double least = absent_share * missingSideLoss(side);
  const bool in_row = side.before + side.after > 0 && rankWeight(side) > 0.0;
  if (!by_doors || !in_row || from.empty() || !to.empty()) return least;
  int missing = side.before + side.after;
  forEachHiddenDoor(from.members, side.side_angle, [&](const MatchProblem::Passage& own) {
    missing = std::min(missing, missingInRow(side, own, from.members));
  });
  return absent_share * sideWeight(side) +
         rankWeight(side) * std::max(absent_share, rankShare(side, missing));
}

std::vector<VertexSet> verticesOf(const MatchProblem& problem, const Assignment& assignment) {
  std::vector<VertexSet> names(problem.nameCount());
  for (std::size_t v = 0; v < assignment.size(); ++v)
    if (assignment[v] >= 0) names[static_cast<std::size_t>(assignment[v])].add(problem, v);
  return names;
}

bool isConnected(const MatchProblem& problem, const PlaceSet& members) {
  if (members.empty()) return true;
  // From a confirmed vertex each, else from any one.
  PlaceSet front, reached;
  members.forEach([&](std::size_t v) {
    if (problem.confirmed_name[v] >= 0) front.insert(v);
  });
  if (front.empty()) front.insert(members.first());
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem.neighbors[v]; });
    front = (next & members) - reached;
  }
  return reached == members;
}

}  // namespace hyselam_topo::merging
