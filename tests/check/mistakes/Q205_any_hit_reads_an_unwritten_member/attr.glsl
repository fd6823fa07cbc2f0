struct Strand { float along; float across; };
