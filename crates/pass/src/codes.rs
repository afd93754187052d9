//! The codes of errors of linking the shaders of a pass to the resources of a pipeline.

data_file::codes! {
    REFUSED = "L001": "A pass cannot record its steps as it is used.";
    ENTRY = "L002": "A shader has no entry point of that name and stage.";
    UNDECLARED = "L003": "A shader reads scene bindings that its pass does not declare.";
    MISMATCH = "L004": "A shader declares a global otherwise than the resource is: its type, access or format.";
    SETTINGS = "L005": "The global `settings` is no uniform of a struct.";
    VALUE = "L006": "Nothing gives a member of `settings` a value, or one that it can hold.";
    UNKNOWN = "L007": "A shader names a resource that is no port, scratch or external of its pass.";
    INDIRECT = "L008": "A dispatch or draw cannot take its size from the buffer that it names.";
}
