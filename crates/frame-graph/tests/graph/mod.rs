mod broken;
mod kinds;
mod off;
mod random;
mod reader;
mod variants;
mod whole;
