// What statements of each kind make of a description, whatever the grammars know.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "building/issue_texts.hpp"
#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/describe_change.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/testing/language_outlines.hpp"
#include "random_statements.hpp"
#include "said_statements.hpp"
#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam_topo {
namespace {

using Lines = std::vector<std::string>;

const TopoParser& parser() {
  static const TopoParser kParser;
  return kParser;
}

/// A conversation: what was told, and what came of it.
class Talk {
 public:
  explicit Talk(const DescriptionParams& params = {}) : builder(parser(), params) {}

  /// Says statements; notes the kinds of their issues.
  Talk& say(const Lines& outlines) {
    for (const std::string& outline : outlines) {
      for (const DescriptionIssue& issue : builder.add(testing::said(outline))) {
        issues.push_back(toString(issue.kind));
        last = issue;
      }
    }
    return *this;
  }
  Lines graph() const { return testing::outline(builder.building()); }

  DescriptionBuilder builder;
  Lines issues;
  DescriptionIssue last;
};

Lines graphOf(const Lines& outlines) {
  Talk talk;
  talk.say(outlines);
  EXPECT_EQ(talk.issues, Lines{}) << talk.last.text << ": " << talk.last.reason;
  return talk.graph();
}

/// The kinds of issues; nothing but `before` may be recorded.
Lines issuesOf(const Lines& before, const std::string& then) {
  Talk talk;
  talk.say(before);
  const Lines graph = talk.graph();
  EXPECT_EQ(talk.issues, Lines{}) << talk.last.text << ": " << talk.last.reason;
  talk.say({then});
  EXPECT_EQ(talk.graph(), graph);
  return talk.issues;
}

TEST(DescriptionBuilder, ContinuesAnEarlierDescription) {
  DescriptionBuilder first(parser());
  first.add(parser().parse("You are in the corridor. On your left you have room A."));
  DescriptionBuilder second(parser());
  second.continueFrom(first.building());
  EXPECT_TRUE(second.add(parser().parse("On your left you have room B.")).empty());
  EXPECT_EQ(testing::outline(second.building()),
            (Lines{"at corridor", "corridor left room A > room B"}));
  second.setRobotPlace("I-5");
  EXPECT_TRUE(second.add(parser().parse("On your right you have room C.")).empty());
  EXPECT_EQ(second.building().places.size(), 5u);
  EXPECT_THROW(second.setLanguage("tlh"), hyselam::ParameterError);
}

TEST(DescriptionBuilder, FailedStatementsChangeNothing) {
  EXPECT_EQ(issuesOf({}, "size place=room_A length=6 width=0"), Lines{"meaningless"});
  EXPECT_EQ(issuesOf({}, "next_to a=kitchen b=kitchen"), Lines{"meaningless"});
  EXPECT_EQ(issuesOf({}, "next_to a=kitchen b=<self>"), Lines{"meaningless"});
  EXPECT_EQ(issuesOf({}, "joined a=kitchen b=kitchen"), Lines{"meaningless"});
}

TEST(DescriptionBuilder, RanksAreKeptAndOrderTheRow) {
  EXPECT_EQ(
      graphOf({"robot_in place=hall", "nth_neighbour nth=3 side=left place=lab",
               "located places=kitchen side=left nth=1", "located places=cellar side=left nth=-1",
               "located places=office side=left nth=2", "neighbours side=left places=archive"}),
      (Lines{"at hall", "hall left kitchen#1 > office#2 > lab#3 > archive > cellar#-1"}));
  // What was told in a row keeps its place.
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=kitchen,lab,office",
                     "located places=lab side=left nth=2"}),
            (Lines{"at hall", "hall left kitchen > lab#2 > office"}));
  EXPECT_EQ(
      graphOf({"located places=lab within=hall nth=2", "located places=lab within=hall nth=2"}),
      (Lines{"hall joins lab#2"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall", "located places=lab side=left nth=2"},
                     "located places=office side=left nth=2"),
            Lines{"contradiction"});
  EXPECT_EQ(issuesOf({"robot_in place=hall", "located places=lab side=left nth=2"},
                     "located places=lab side=left nth=3"),
            Lines{"contradiction"});
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "located places=lab,office side=left nth=2"),
            Lines{"meaningless"});
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=left nth=2",
                     "no located places=office side=left nth=2"}),
            (Lines{"at hall", "hall left office#2 > lab"}));
}

TEST(DescriptionBuilder, SeveralRelationsInOneStatement) {
  EXPECT_EQ(graphOf({"robot_in place=hall",
                     "located places=lab side=left nth=2 distance=10 next_to=kitchen,office "
                     "opposite=room_B size_word=large doors=2 area=30"}),
            (Lines{"at hall", "hall left lab#2@10", "lab area 30", "lab doors 2", "lab large",
                   "lab next_to kitchen", "lab next_to office", "lab opposite room B"}));
  EXPECT_EQ(
      graphOf({"robot_in place=hall", "located places=lab side=right end_of=hall between=A,B"}),
      (Lines{"at hall", "hall right lab", "lab at_end_of hall", "lab between A | B"}));
  EXPECT_EQ(graphOf({"located places=lab behind=reception to=kitchen via=hall"}),
            (Lines{"hall joins lab", "kitchen joins lab", "lab behind reception"}));
  EXPECT_EQ(issuesOf({}, "located places=lab side=left"), Lines{"no context"});
  EXPECT_EQ(issuesOf({}, "located places=lab"), Lines{"meaningless"});
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "located places=lab side=left from=kitchen"),
            Lines{"no context"});
}

TEST(DescriptionBuilder, OrderInARowAfterAndBefore) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=kitchen,office",
                     "located places=lab side=left after=kitchen"}),
            (Lines{"at hall", "hall left kitchen > lab > office", "lab after kitchen | hall"}));
  EXPECT_EQ(graphOf({"located places=lab after=kitchen", "located places=office before=kitchen"}),
            (Lines{"kitchen after office", "lab after kitchen"}));
  EXPECT_EQ(graphOf({"located places=lab after=kitchen from=hall"}),
            (Lines{"lab after kitchen | hall"}));
  EXPECT_EQ(issuesOf({"located places=lab after=kitchen"}, "located places=kitchen after=lab"),
            Lines{"contradiction"});
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=kitchen",
                     "alias place=<next> aliases=lab"}),
            (Lines{"at hall", "hall left kitchen > lab", "lab after kitchen | hall"}));
  EXPECT_EQ(issuesOf({}, "alias place=<next> aliases=lab"), Lines{"no context"});
  EXPECT_EQ(graphOf({"row places=kitchen,lab,office"}),
            (Lines{"kitchen next_to lab", "lab next_to office"}));
  EXPECT_EQ(issuesOf({}, "row places=kitchen"), Lines{"meaningless"});
}

TEST(DescriptionBuilder, DistancesInMetresAndSteps) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=front steps=10"}),
            (Lines{"at hall", "hall front lab@7.5"}));
  // Told by rule of thumb.
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=front distance=10",
                     "located places=lab side=front distance=11"}),
            (Lines{"at hall", "hall front lab@10"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall", "located places=lab side=front distance=10"},
                     "located places=lab side=front distance=20"),
            Lines{"contradiction"});
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "located places=lab distance=20"),
            Lines{"meaningless"});
  Talk talk;
  talk.say({"located places=lab next_to=kitchen distance=20"});
  EXPECT_EQ(talk.graph(), Lines{"lab next_to kitchen"});
  EXPECT_EQ(talk.issues, Lines{"notice"});
}

TEST(DescriptionBuilder, OtherFloorsAreJoinedWithNothingHere) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab floor=1"}),
            (Lines{"at hall", "lab floor 1"}));
  EXPECT_EQ(graphOf({"located places=lab floor=-2", "located places=office floor=0"}),
            (Lines{"lab floor -2", "office floor 0"}));
  Talk talk;
  talk.say({"robot_in place=hall", "located places=lab floor=1 side=left"});
  EXPECT_EQ(talk.graph(), (Lines{"at hall", "lab floor 1"}));
  EXPECT_EQ(talk.issues, Lines{"notice"});
  EXPECT_EQ(issuesOf({"located places=lab floor=1"}, "located places=lab floor=2"),
            Lines{"contradiction"});
  EXPECT_EQ(graphOf({"located places=lab floor=1", "no located places=lab floor=2"}),
            Lines{"lab floor 2"});
}

TEST(DescriptionBuilder, SizesByWordAndByComparison) {
  EXPECT_EQ(graphOf({"size_word place=lab,office size_word=small", "larger a=library b=lab"}),
            (Lines{"lab small", "library larger lab", "office small"}));
  EXPECT_EQ(issuesOf({"larger a=library b=lab"}, "larger a=lab b=library"), Lines{"contradiction"});
  EXPECT_EQ(graphOf({"larger a=library b=lab", "no larger a=lab b=library"}),
            Lines{"lab larger library"});
  EXPECT_EQ(
      issuesOf({"size_word place=lab size_word=small"}, "size_word place=lab size_word=large"),
      Lines{"contradiction"});
  EXPECT_EQ(graphOf({"size_word place=lab size_word=small",
                     "size_word place=lab size_word=small denied=yes", "exists places=lab"}),
            Lines{"place lab"});
}

TEST(DescriptionBuilder, DoorsAndWhereTheyLead) {
  EXPECT_EQ(graphOf({"doors place=kitchen doors=2 to=hall,pantry"}),
            (Lines{"kitchen doors 2", "kitchen joins hall", "kitchen joins pantry"}));
  EXPECT_EQ(issuesOf({}, "doors place=kitchen doors=1 to=hall,pantry"), Lines{"meaningless"});
  EXPECT_EQ(issuesOf({"doors place=kitchen doors=1"}, "doors place=kitchen doors=2"),
            Lines{"contradiction"});
  EXPECT_EQ(graphOf({"joined a=hall b=kitchen,lab"}),
            (Lines{"hall joins kitchen", "hall joins lab"}));
}

TEST(DescriptionBuilder, DenialsRemoveAndAreKept) {
  EXPECT_EQ(graphOf({"next_to a=lab b=office", "next_to a=office b=lab denied=yes"}),
            Lines{"not office next_to lab"});
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=lab,office",
                     "located places=lab side=left denied=yes"}),
            (Lines{"at hall", "hall left office", "not lab at_side left hall"}));
  // Another side is no contradiction, the same one is.
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=right denied=yes",
                     "neighbours side=left places=<it>"}),
            (Lines{"at hall", "hall left lab", "not lab at_side right hall"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall", "located places=lab side=right denied=yes"},
                     "neighbours side=right places=lab"),
            Lines{"contradiction"});
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=right denied=yes",
                     "no neighbours side=right places=lab"}),
            (Lines{"at hall", "hall right lab"}));
  EXPECT_EQ(graphOf({"joined a=hall b=lab", "joined a=lab b=hall denied=yes"}),
            Lines{"not lab joined hall"});
  EXPECT_EQ(
      graphOf({"located places=lab next_to=office denied=yes", "larger a=lab b=hall denied=yes",
               "part_of a=lab b=hall denied=yes", "between a=lab b=A c=B denied=yes",
               "located places=lab behind=hall denied=yes",
               "contains inside=hall places=lab denied=yes"}),
      (Lines{"not lab behind hall", "not lab between A | B", "not lab inside hall",
             "not lab joined hall", "not lab larger hall", "not lab next_to office"}));
  EXPECT_EQ(graphOf({"located places=lab end_of=hall", "at_end_of a=lab b=hall denied=yes"}),
            Lines{"not lab at_end_of hall"});
  EXPECT_EQ(issuesOf({}, "located places=lab next_to=office behind=hall denied=yes"),
            Lines{"meaningless"});
  EXPECT_EQ(issuesOf({}, "size place=lab length=2 width=3 denied=yes"), Lines{"meaningless"});
  EXPECT_EQ(graphOf({"robot_in place=lab", "robot_in place=lab denied=yes"}), Lines{"place lab"});
  EXPECT_EQ(
      graphOf({"alias place=room_3 aliases=lab", "alias place=room_3 aliases=lab denied=yes"}),
      Lines{"place room 3"});
  EXPECT_EQ(issuesOf({"exists places=room_3"}, "alias place=room_3 aliases=lab denied=yes"),
            Lines{"no context"});
}

TEST(DescriptionBuilder, NotThereButElsewhere) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=lab",
                     "located places=lab was_side=left side=right instead=yes"}),
            (Lines{"at hall", "hall right lab", "not lab at_side left hall"}));
  EXPECT_EQ(graphOf({"next_to a=lab b=office",
                     "located places=lab was=office opposite=kitchen instead=yes"}),
            (Lines{"lab opposite kitchen", "place office"}));
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=left nth=2",
                     "located places=lab was_nth=2 side=left nth=3 instead=yes"}),
            (Lines{"at hall", "hall left lab#3"}));
  EXPECT_EQ(graphOf({"robot_in place=library", "neighbours side=left places=kitchen",
                     "this_is was=library place=lab"}),
            (Lines{"at lab", "lab left kitchen"}));
  EXPECT_EQ(graphOf({"exists places=kitchen", "this_is was=library place=lab"}),
            (Lines{"at lab", "place kitchen"}));
  EXPECT_EQ(graphOf({"alias place=room_3 aliases=John's_office",
                     "alias place=room_3 was=John's_office aliases=Jack's_office"}),
            Lines{"room 3 aka Jack's office"});
}

TEST(DescriptionBuilder, BothAreJoined) {
  EXPECT_EQ(graphOf({"located places=lab,store next_to=lift", "joined both=<they>"}),
            (Lines{"lab joins store", "lab next_to lift", "store next_to lift"}));
  EXPECT_EQ(issuesOf({"located places=lab,store,bar next_to=lift"}, "joined both=<they>"),
            Lines{"ask"});
}

TEST(DescriptionBuilder, WhatMovedIsNoLongerWhereItWas) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=lab",
                     "next_to a=lab b=bar", "located places=lab opposite=lift moved=yes"}),
            (Lines{"at hall", "lab opposite lift", "place bar"}));
}

TEST(DescriptionBuilder, OneNumberIsReplaced) {
  EXPECT_EQ(graphOf({"length_of place=lab length=6", "no replace_number instead=7"}),
            Lines{"lab length 7"});
  // Which of two, and in which unit: not guessed.
  EXPECT_EQ(issuesOf({"size place=lab length=6 width=4"}, "no replace_number instead=7"),
            Lines{"no context"});
  EXPECT_EQ(issuesOf({"length_of place=lab length=1.8288"}, "no replace_number instead=7"),
            Lines{"no context"});
  EXPECT_EQ(issuesOf({}, "no replace_number instead=7"), Lines{"no context"});
}

TEST(DescriptionBuilder, OwnersOfPlacesWithoutAName) {
  EXPECT_EQ(graphOf({"owner_located owners=Joe,Ann room_kind=lab next_to=lift"}),
            (Lines{"Joe's lab aka Ann's lab", "Joe's lab next_to lift"}));
}

/// A slot that the builder does not read would be dropped without a word.
TEST(DescriptionBuilder, ReadsAllSlotsOfTheGrammars) {
  const std::set<std::string> read{
      "across",   "here",      "both",    "former",      "owned",     "room_kind", "speaker_too",
      "unit",     "moved",     "a",       "after",       "aliases",   "area",      "b",
      "before",   "behind",    "between", "c",           "count",     "denied",    "distance",
      "doors",    "end_of",    "floor",   "floors_down", "floors_up", "from",      "from_end",
      "inside",   "instead",   "kind",    "length",      "name",      "named",     "next_to",
      "nth",      "opposite",  "owners",  "part_of",     "person",    "place",     "places",
      "side",     "size_word", "steps",   "to",          "via",       "was",       "was_nth",
      "was_side", "width",     "within"};
  for (const Grammar& grammar : parser().grammars()) {
    for (const language::IntentInfo& intent : grammar.compiled().intents) {
      if (!DescriptionBuilder::handles(intent.as.empty() ? intent.name : intent.as)) continue;
      for (const language::Automaton& pattern : intent.patterns) {
        for (const language::SlotType& slot : pattern.slots) {
          EXPECT_EQ(read.count(slot.name), 1u)
              << grammar.language() << " " << intent.name << ": " << slot.name;
        }
      }
    }
  }
}

TEST(DescriptionBuilder, RankMayBeDenied) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "located places=lab side=left nth=2",
                     "located places=lab side=left nth=2 denied=yes"}),
            (Lines{"at hall", "hall left lab"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "located places=lab side=left nth=2 denied=yes"),
            Lines{"meaningless"});
}

TEST(DescriptionBuilder, CorrectionsReplace) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=lab",
                     "no located places=<it> side=right"}),
            (Lines{"at hall", "hall right lab"}));
  EXPECT_EQ(graphOf({"next_to a=lab b=office", "no next_to a=lab b=kitchen"}),
            (Lines{"lab next_to kitchen", "place office"}));
  // Of several, the one told last.
  EXPECT_EQ(
      graphOf({"next_to a=lab b=office", "next_to a=lab b=hall", "no next_to a=lab b=kitchen"}),
      (Lines{"lab next_to kitchen", "lab next_to office", "place hall"}));
  EXPECT_EQ(graphOf({"alias place=room_3 aliases=John's_office",
                     "no alias place=<it> aliases=Jack's_office"}),
            Lines{"room 3 aka Jack's office"});
  EXPECT_EQ(graphOf({"joined a=kitchen b=garage", "no joined a=kitchen b=pantry"}),
            (Lines{"kitchen joins pantry", "place garage"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall", "neighbours side=left places=kitchen"},
                     "no neighbours side=left places=study"),
            Lines{"no context"});
  Talk talk;
  talk.say({"no next_to a=lab b=office"});
  EXPECT_EQ(talk.graph(), Lines{"lab next_to office"});
  EXPECT_EQ(talk.issues, Lines{"notice"});
}

TEST(DescriptionBuilder, NoPronounReachesAcrossARefusedSentence) {
  Talk talk;
  talk.say({"exists places=corridor"});
  Utterance refused;
  refused.text = "The library's humongous.";
  EXPECT_TRUE(talk.builder.add(refused).empty());
  talk.say({"next_to a=<it> b=kitchen"});
  EXPECT_EQ(talk.issues, Lines{"no context"});
  // Neither across one that failed.
  Talk failed;
  failed.say({"exists places=corridor", "next_to a=lab b=lab", "next_to a=<it> b=kitchen"});
  EXPECT_EQ(failed.issues, (Lines{"meaningless", "no context"}));
  // What was not understood may be what is corrected.
  Talk corrected;
  corrected.say({"exists places=corridor"});
  corrected.builder.sentenceRefused();
  corrected.say({"no next_to a=lab b=kitchen"});
  EXPECT_EQ(corrected.issues, Lines{"notice"});
  EXPECT_EQ(corrected.graph(), (Lines{"lab next_to kitchen", "place corridor"}));
}

TEST(DescriptionBuilder, PlacesOfOneNameAreTwo) {
  Talk talk;
  talk.say({"robot_in place=hall", "each_side places=toilets count=2"});
  EXPECT_EQ(talk.issues, Lines{});
  EXPECT_EQ(talk.graph(), (Lines{"at hall", "hall left toilet", "hall right toilet~2"}));
  talk.say({"next_to a=kitchen b=toilet"});
  EXPECT_EQ(talk.issues, Lines{"ask"});
  EXPECT_EQ(talk.last.reason,
            "which 'toilet': on the left of the hall or on the right of the hall?");
  EXPECT_EQ(graphOf({"exists places=meeting_rooms count=2", "next_to a=<one> b=reception",
                     "at_end_of a=<other> b=corridor"}),
            (Lines{"corridor joins meeting room~2", "meeting room next_to reception",
                   "meeting room~2 at_end_of corridor"}));
  EXPECT_EQ(graphOf({"exists places=labs count=2", "located places=kitchen between=labs"}),
            Lines{"kitchen between lab | lab~2"});
  EXPECT_EQ(
      graphOf({"robot_in place=corredor", "each_side places=casas_de_banho"}),
      (Lines{"at corredor", "corredor left casa de banho", "corredor right casa de banho~2"}));
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=toilets count=2"}),
            (Lines{"at hall", "hall left toilet > toilet~2"}));
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "neighbours side=left places=lab count=2"),
            Lines{"meaningless"});
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "each_side places=toilets count=3"),
            Lines{"meaningless"});
  EXPECT_EQ(issuesOf({"robot_in place=hall"}, "each_side places=toilet,lab"), Lines{"ask"});
}

TEST(DescriptionBuilder, WordsThatStandForPlaces) {
  EXPECT_EQ(graphOf({"robot_in place=hall", "neighbours side=left places=A,B,C",
                     "size_word place=<first> size_word=large",
                     "size_word place=<last> size_word=small"}),
            (Lines{"A large", "C small", "at hall", "hall left A > B > C"}));
  EXPECT_EQ(graphOf({"exists places=labs count=2", "size_word place=labs size_word=small"}),
            (Lines{"lab small", "lab~2 small"}));
  EXPECT_EQ(graphOf({"exists places=lounge", "joined a=<it> b=terrace", "next_to a=bar b=<it>"}),
            (Lines{"bar next_to lounge", "lounge joins terrace"}));
  EXPECT_EQ(graphOf({"exists places=A,B", "located places=<they> floor=1"}),
            (Lines{"A floor 1", "B floor 1"}));
  EXPECT_EQ(issuesOf({"exists places=A,B,C", "next_to a=A b=lab"},
                     "size_word place=<other> size_word=small"),
            Lines{"no context"});
  EXPECT_EQ(issuesOf({}, "size_word place=<first> size_word=small"), Lines{"no context"});
  EXPECT_EQ(issuesOf({"exists places=A,B"}, "size_word place=<it> size_word=small"),
            Lines{"ambiguous"});
}

TEST(DescriptionBuilder, OwnersAndWhoSpeaks) {
  EXPECT_EQ(graphOf({"owner place=room_214 owners=Mr._Henderson"}),
            Lines{"room 214 aka Mr. Henderson's office"});
  EXPECT_EQ(graphOf({"owner place=lab_3 owners=Tom,Ann"}),
            Lines{"lab 3 aka Tom's lab > Ann's lab"});
  EXPECT_EQ(
      graphOf({"size_word place=Tom's_office size_word=small", "owner place=room_214 owners=Tom"}),
      (Lines{"Tom's office aka room 214", "Tom's office small"}));
  EXPECT_EQ(issuesOf({}, "next_to a=my:office b=kitchen"), Lines{"ask"});
  EXPECT_EQ(graphOf({"speaker person=Lisa", "next_to a=my:office b=kitchen",
                     "size_word place=Lisa's_office size_word=small"}),
            (Lines{"Lisa's office next_to kitchen", "Lisa's office small"}));
  Talk talk;
  talk.builder.setLanguage("pt");
  talk.builder.setSpeaker("Lisa");
  talk.say({"next_to a=my:gabinete b=cozinha", "owner place=sala_3 owners=Rui",
            "size_word place=gabinete_do_Rui size_word=small"});
  EXPECT_EQ(talk.issues, Lines{});
  EXPECT_EQ(talk.graph(), (Lines{"gabinete de Lisa next_to cozinha", "sala 3 aka gabinete de Rui",
                                 "sala 3 small"}));
  Utterance theirs = testing::said("next_to a=Mary's b=kitchen");
  theirs.slots[0].names[0].elliptic = true;
  EXPECT_EQ(talk.builder.add(theirs).size(), 0u);
  EXPECT_EQ(talk.builder.speaker(), "Lisa");
}

TEST(DescriptionBuilder, StrangeNamesAreAskedAbout) {
  for (const char* name : {"uh-huh", "Sorry", "great", "Tom", "secret", "danger", "kitchen_sink",
                           "kichen", "Atlantis"}) {
    Talk talk;
    talk.say({std::string("next_to b=corridor a=") + name});
    EXPECT_EQ(talk.issues, Lines{"strange name"}) << name;
    EXPECT_EQ(talk.graph(), Lines{}) << name;
    EXPECT_FALSE(talk.last.name.empty());
    talk.builder.acceptName(talk.last.name);
    talk.issues.clear();
    talk.say({std::string("next_to b=corridor a=") + name});
    EXPECT_EQ(talk.issues, Lines{}) << name;
  }
  for (const char* name :
       {"Tom's", "Tom's_office", "gabinete_do_Rui", "room_A", "I-109", "110", "office_of_Tom",
        "\"uh-huh\"", "room_Mozart", "waiting_area", "sala_de_reuniões", "printer_room", "room_two",
        "B", "casas_de_banho", "toilets"}) {
    Talk talk;
    talk.say({std::string("next_to b=corridor a=") + name});
    EXPECT_EQ(talk.issues, Lines{}) << name;
  }
  EXPECT_EQ(graphOf({"exists places=Atlantis named=yes"}), Lines{"place Atlantis"});
  EXPECT_EQ(graphOf({"alias place=room_3 aliases=Atlantis"}), Lines{"room 3 aka Atlantis"});
  DescriptionParams trusting;
  trusting.ask_strange_names = false;
  Talk talk(trusting);
  talk.say({"next_to a=Atlantis b=kitchen"});
  EXPECT_EQ(talk.issues, Lines{});
}

TEST(DescriptionBuilder, WhatIsGone) {
  EXPECT_EQ(graphOf({"next_to a=lab b=office", "gone places=lab"}), Lines{"place office"});
  EXPECT_EQ(graphOf({"next_to a=lab b=office", "exists places=lab denied=yes"}),
            Lines{"place office"});
  EXPECT_EQ(issuesOf({"exists places=office"}, "gone places=lab"), Lines{"no context"});
  EXPECT_EQ(issuesOf({"exists places=office"}, "forget_place place=lab"), Lines{"no context"});
}

TEST(DescriptionBuilder, StatementsAreTakenBack) {
  Talk talk;
  EXPECT_FALSE(talk.builder.undo());
  EXPECT_EQ(talk.builder.lastStatement(), nullptr);
  talk.say({"robot_in place=hall", "neighbours side=left places=lab", "next_to a=lab b=lab"});
  ASSERT_NE(talk.builder.lastStatement(), nullptr);
  EXPECT_EQ(talk.builder.lastStatement()->intent, "neighbours");
  talk.issues.clear();
  talk.say({"undo"});
  EXPECT_EQ(talk.graph(), Lines{"at hall"});
  talk.say({"undo"});
  EXPECT_EQ(talk.graph(), Lines{});
  EXPECT_EQ(talk.issues, Lines{});
  talk.say({"undo"});
  EXPECT_EQ(talk.issues, Lines{"no context"});
}

/// The orders of each row are 0, 1, 2, ...
bool areOrdersCounted(const DescribedBuilding& building) {
  std::map<std::pair<Id, Side>, std::set<std::size_t>> rows;
  for (const DescribedConnection& each : building.connections) {
    if (!rows[{each.from, each.side}].insert(each.order).second) return false;
  }
  return std::all_of(rows.begin(), rows.end(),
                     [](const auto& row) { return *row.second.rbegin() + 1 == row.second.size(); });
}

/// Says random statements: each that changes the description is taken back and said again.
void expectUndone(unsigned seed) {
  testing::RandomStatements random(seed);
  DescriptionBuilder builder(parser());
  for (int i = 0; i < 60; ++i) {
    const std::string statement = random.statement();
    const DescribedBuilding before = builder.building();
    builder.add(testing::said(statement));
    const DescribedBuilding after = builder.building();
    // Whatever is said, it is a description.
    ASSERT_NO_THROW(checkDescription(after, statement));
    ASSERT_TRUE(areOrdersCounted(after)) << "seed " << seed << ": " << statement;
    ASSERT_NO_THROW(describeChange(before, after, parser().grammars()[seed % 2])) << statement;
    if (after == before) continue;
    ASSERT_TRUE(builder.undo());
    ASSERT_TRUE(builder.building() == before) << "seed " << seed << ": " << statement;
    builder.add(testing::said(statement));
    ASSERT_TRUE(builder.building() == after) << "seed " << seed << ": " << statement;
  }
}

TEST(DescriptionBuilder, UndoRestoresTheFormerDescription) {
  for (unsigned seed = 0; seed < 30; ++seed) expectUndone(seed);
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
RC_GTEST_PROP(DescriptionBuilder, UndoRestoresWhateverWasSaid, (unsigned seed)) {
  expectUndone(seed);
}
#endif

TEST(DescriptionBuilder, EverythingIsForgotten) {
  Talk talk;
  talk.say({"robot_in place=hall", "neighbours side=left places=lab", "forget_everything"});
  EXPECT_TRUE(talk.builder.building() == DescribedBuilding());
  talk.say({"undo"});
  EXPECT_EQ(talk.graph(), (Lines{"at hall", "hall left lab"}));
}

TEST(DescriptionBuilder, LastStatementIsSaidAgainWithAnotherName) {
  EXPECT_EQ(
      graphOf({"robot_in place=hall", "neighbours side=left places=lab", "replace name=office"}),
      (Lines{"at hall", "hall left office"}));
  EXPECT_EQ(graphOf({"next_to a=lab b=office", "replace name=kitchen instead=office"}),
            Lines{"lab next_to kitchen"});
  EXPECT_EQ(issuesOf({"next_to a=lab b=office"}, "replace name=kitchen"), Lines{"ask"});
  EXPECT_EQ(graphOf({"next_to a=John's_office b=kitchen", "replace name=Jack's_office"}),
            Lines{"Jack's office next_to kitchen"});
  EXPECT_EQ(issuesOf({"next_to a=lab b=office"}, "replace name=kitchen instead=hall"),
            Lines{"no context"});
  EXPECT_EQ(issuesOf({}, "replace name=kitchen"), Lines{"no context"});
  // A statement that does not hold with the other name stays as it was.
  EXPECT_EQ(issuesOf({"next_to a=lab b=office"}, "replace name=lab instead=office"),
            Lines{"meaningless"});
}

TEST(DescriptionBuilder, CorrectionsOfTheSamePlaceMayAdd) {
  const auto tell = [](const std::string& then) {
    Talk talk;
    talk.builder.add(
        parser().parse("You are in the corridor. The kitchen is next to the library."));
    for (const auto& issue : talk.builder.add(parser().parse(then))) {
      talk.issues.push_back(toString(issue.kind));
    }
    return talk.issues;
  };
  EXPECT_EQ(Lines{"notice"}, tell("No, the kitchen is the second door on the left."));
  EXPECT_EQ(Lines{"no context"}, tell("No, the archive is the second door on the left."));
}

TEST(DescriptionBuilder, TheCorridorIsTheOneWhereTheRobotIs) {
  DescriptionBuilder builder(parser());
  builder.add(
      parser().parse("You are in the main corridor. The lab is at the end of the corridor."));
  EXPECT_EQ(2u, builder.building().places.size());
  builder.add(parser().parse("The lab is next to the service corridor. You are in the lab."));
  EXPECT_EQ(3u, builder.building().places.size());
  EXPECT_EQ(builder.find("main corridor"), builder.find("corridor")) << "it was called so before";
}

TEST(DescriptionBuilder, ReasonsAreInTheLanguageSpoken) {
  Talk talk;
  talk.builder.setLanguage("pt");
  talk.say({"neighbours side=left places=sala_A"});
  for (const std::string& key : issueKeys()) {
    EXPECT_TRUE(parser().grammar("pt").has("issue_" + key)) << key;
    EXPECT_FALSE(issueText(parser().grammar("en"), key).empty()) << key;
  }
  EXPECT_EQ(talk.last.reason, "não me disseram onde está o robô: diga 'você está em ...'");
}

TEST(DescriptionBuilder, ASubjectThatWasLeftOutIsNotQuoted) {
  DescriptionBuilder builder(parser());
  builder.setLanguage("pt");
  const auto issues = builder.add(parser().parse("É logo ao pé da entrada."));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].reason, "não sei de que lugar se fala: diga o nome");
}

}  // namespace
}  // namespace hyselam_topo
