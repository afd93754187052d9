mod broken;
mod kinds;
mod random;
mod reader;
mod variants;
mod whole;
