float visibility( float alpha, float o, float i ) { return 0.25 / ( o + i - o * i ); }
