//! The codes of errors of pipelines, beside those of their text.

pub(crate) use data_file::codes::{BAD_NAME, MISSING_FIELD, NESTING, UNKNOWN_FIELD, WRONG_TYPE};

data_file::codes! {
    NO_FILE = "E010": "A file that `extends`, `Sub` or the command line names does not exist, or is outside of the folders whose files may be named.";
    EXTENDS_LOOP = "E011": "A file extends itself, directly or through others.";
    SUB_LOOP = "E012": "A sub-graph contains itself, directly or through others.";
    TOO_LARGE = "E013": "Files are nested too deeply, or the flattened pipeline has too many passes.";
    DEFINED_TWICE = "E014": "A variant adds a pass whose name is taken; `Replace` is the patch for that.";
    PATCH_TARGET = "E015": "A patch names a pass that is not there.";
    PATCH_LINK = "E016": "`Insert` names two ports that no link joins.";
    PATH = "E017": "`Set` or `--set` names a parameter or setting that is not there.";
    UNKNOWN_PARAMETER = "E018": "`$name` or a switch names a parameter that is not declared.";
    PARAMETER = "E019": "A parameter's value is of the wrong type, out of range, or not one of its choices.";
    UNKNOWN_KIND = "E020": "There is no pass type of that name.";
    SHADER = "E021": "A pass type that takes a shader lacks one, or names one that is not there, or one is given to a pass type that takes none.";
    UNKNOWN_SETTING = "E022": "The pass type has no setting of that name.";
    SETTING_TYPE = "E023": "A setting's value is of the wrong type.";
    SETTING_RANGE = "E024": "A setting's value is out of range, or not one of its choices.";
    REFUSED = "E025": "The pass type refuses this use of it.";
    UNKNOWN_PASS = "E030": "A link names a pass or input that is not there.";
    UNKNOWN_PORT = "E031": "A link names a port or member that the pass does not have.";
    AMBIGUOUS = "E032": "A link names a pass or port that could mean several resources.";
    UNKNOWN_INPUT = "E033": "The pass has no input of that name.";
    UNLINKED = "E034": "An input that the pass needs is not linked.";
    INTERFACE = "E035": "The two ends of a link have different interfaces.";
    CYCLE = "E037": "Passes depend on each other in a loop; one link must read a history buffer with `prev`.";
    PAST = "E038": "A `prev` link reads a history buffer of a history buffer, or a pass hands on what such a link reads.";
    OFF_READ = "E039": "Something reads a pass that is switched off or removed and has no `off:`.";
    EXPRESSION = "E040": "An expression cannot be read.";
    EXPRESSION_NAME = "E041": "An expression names a trait or function that is not there.";
    EXPRESSION_TYPE = "E042": "An expression joins values of types that do not go together.";
    OFF = "E043": "What `off:` names as replacement of a pass does not fit the outputs of that pass.";
    OFF_LOOP = "E045": "Passes that are off replace each other in a loop.";
    ARITHMETIC = "E046": "An expression divides by zero, or its value is beyond what a number can hold.";
    SIZE_INPUT = "E050": "A size is relative to an input that is not linked or has no texture.";
    SIZE_LOOP = "E051": "A size depends on itself through `prev`.";
    SIZE_LIMIT = "E052": "A size is zero or larger than any device allows.";
    KIND_DEFECT = "E053": "A pass type describes outputs that do not match its own ports: a bug in the pass type.";
    UNKNOWN_OUTPUT = "E060": "An output or resource that was requested is not there.";
    NO_OUTPUTS = "E061": "The pipeline has no outputs, so nothing in it is needed.";
    SUB_AS_PIPELINE = "E062": "A sub-graph, which has `inputs`, was used as a whole pipeline.";
    REMOVED = "W001": "A patch removed a pass without `off:`: links and outputs of the pipeline are lost with it.";
    NO_EFFECT = "W003": "A value has no effect: nothing uses the parameter, it is set or replaced again in the same file, or no pass that runs takes it.";
    LEFT_OUT = "W004": "The pipeline leaves out light that the scene has.";
    OTHER_FORMAT = "W005": "A texture of an output is not of the format of its interface.";
    LACKS_MEMBER = "W006": "An output lacks an optional member of its interface, which an input of that interface has.";
}
